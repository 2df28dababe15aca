"""Random tasks of joint lifting, for trials."""

import numpy as np
from hybrid_tamp_domains.joint_lifting import DOMAIN
from hybrid_tamp_domains.joint_lifting.classes import Liftable
from hybrid_tamp_domains.joint_lifting.load import RESERVE, bearable
from numpy.typing import ArrayLike

from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.skills import StaticEndEffector
from random_tasks.corners import Corner

_HAND = {
    "radius": 0.035,
    "length": 0.16,
    "mass": 1.5,
    "maximal_force": 300.0,
    "workspace_lower": (-2.0, -2.0, 0.0),
    "workspace_upper": (2.0, 2.0, 1.5),
}
_WIDTHS = {2: (0.06, 0.25), 4: (0.12, 0.3)}
"""Half extents along y [m]. Two hands fit side by side on a box for four hands."""
_LOADS = {2: (0.3, 0.95), 4: (1.05, 1.9)}
"""Masses as shares of the load that two hands bear. A box for four hands is too heavy for two hands."""


def random_lifting(seed: int, hands: int = 2, rng: np.random.Generator | Corner | None = None) -> Task:
    """Return a task in which two hands lift a light box, or in which four hands of two robots lift a heavy box.

    Half extents: x U(0.08, 0.22) m; y U(0.06, 0.25) m for two hands and U(0.12, 0.3) m for four; z U(0.06, 0.2) m.
    Friction U(0.4, 0.9). Mass as a share of the load that two hands bear: U(0.3, 0.95) for two hands, U(1.05, 1.9) for
    four. The box is displaced by up to 3 cm and 3 degrees. The upright hands start 0.5 m beside the box, at a
    height of 0.4 m, with deviations of up to 5 cm.
    """
    rng = rng or np.random.default_rng(seed)
    halves = [float(rng.uniform(*bounds)) for bounds in ((0.08, 0.22), _WIDTHS[hands], (0.06, 0.2))]
    friction = float(rng.uniform(0.4, 0.9))
    ends = [Token.make(f"hand {number + 1}", [StaticEndEffector], _HAND) for number in range(hands)]
    own = {"half_extents": tuple(halves), "friction": friction, "mass": 1.0}
    light = Token.make("box", [Liftable], own)
    mass = float(rng.uniform(*_LOADS[hands])) * 2.0 * bearable(ends[0], light, RESERVE) / GRAVITY
    box = Token.make("box", [Liftable], {**own, "mass": mass})
    x, y = rng.uniform(-0.03, 0.03, 2)
    given: dict[tuple[str, str], ArrayLike] = {
        ("box", "position"): (x, y, halves[2]),
        ("box", "orientation"): quaternion_from_rpy(np.array([0.0, 0.0, np.radians(rng.uniform(-3.0, 3.0))])),
    }
    for number, end in enumerate(ends):
        row = 0.0 if hands == 2 else (-0.3, 0.3)[number // 2]
        place = np.array([(-0.5, 0.5)[number % 2], row, 0.4]) + rng.uniform(-0.05, 0.05, 3)
        given[end.name, "position"] = place
    tokens = (*ends, box)
    robots = {f"robot {number + 1}": tuple(e.name for e in ends[2 * number :][:2]) for number in range(hands // 2)}
    return Task(
        f"lift_{seed}",
        DOMAIN,
        tokens,
        State.of(tokens, given),
        (Atom("raised", ("box",)),),
        agents=robots,
        seed=seed,
    )
