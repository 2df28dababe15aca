"""Random tasks of carrying a box through a gap in a wall, for trials."""

import numpy as np
from hybrid_tamp_domains.joint_lifting import DOMAIN

from hybrid_tamp.geometry.shapes import Box
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy, quaternion_multiply, rotate
from hybrid_tamp.skills import Region
from random_tasks.lifting import random_lifting

_HALF_THICKNESS, _HEIGHT = 0.05, 1.6
"""Half thickness and height of the wall [m]. No hand can carry the box over the wall."""
_HALF_LENGTH = 2.0
"""Half length of each part of the wall [m]. No hand can carry the box around the wall."""
_REACH = 2.5
"""Half edge of the workspace of each hand [m]."""


def random_carrying(seed: int, hands: int = 2, gaps: tuple[float, float] = (1.2, 2.0)) -> Task:
    """Return a task in which hands carry a box through a gap in a wall, and set it down in a region.

    The box and the hands are those of `random_lifting`. The wall is across the way, U(0.85, 1.1) m from the origin.
    Across the way, its gap is U(1.2, 2) times as wide as the box, and U(-0.3, 0.3) m beside the box. The region is
    U(0.15, 0.35) m behind the place at which the box has passed the wall, and U(-0.3, 0.3) m beside the gap. The whole
    scene has any yaw.

    Args:
        seed: seed of the task.
        hands: number of hands, two or four.
        gaps: smallest and largest width of the gap as a multiple of the width of the box.
    """
    rng = np.random.default_rng([seed, 5])
    lifting = random_lifting(seed, hands)
    half_x, half_y, _ = lifting.token_by_name["box"]["half_extents"]
    axes = rotate(lifting.state["box", "orientation"], np.diag([half_x, half_y, 0.0]))
    half_length, half_width, _ = np.abs(axes).sum(axis=0)
    ahead, beside = float(rng.uniform(0.85, 1.1)), float(rng.uniform(-0.3, 0.3))
    gap = float(rng.uniform(*gaps)) * 2.0 * half_width
    passed = ahead + _HALF_THICKNESS + half_length + 2.0 * 0.035 + float(rng.uniform(0.15, 0.35))
    turn = quaternion_from_rpy(np.array([0.0, 0.0, rng.uniform(-np.pi, np.pi)]))
    goal = Token.make("goal", [Region], {"radius": 0.05})
    shape = Box(kind="box", half_extents=(_HALF_THICKNESS, _HALF_LENGTH, _HEIGHT / 2))
    walls = [Token.make(f"{side} wall", [], {}, shape, immovable=True) for side in ("right", "left")]
    places = {
        token.name: (lifting.state[token, "position"], lifting.state[token, "orientation"]) for token in lifting.tokens
    }
    upright = np.array([0.0, 0.0, 0.0, 1.0])
    places["goal"] = np.array([passed, beside + rng.uniform(-0.3, 0.3), 0.0]), upright
    for wall, sign in zip(walls, (-1.0, 1.0), strict=True):
        places[wall.name] = np.array([ahead, beside + sign * (gap / 2 + _HALF_LENGTH), _HEIGHT / 2]), upright
    given = {(name, "position"): rotate(turn, place) for name, (place, _) in places.items()}
    given |= {(name, "orientation"): quaternion_multiply(turn, spin) for name, (_, spin) in places.items()}
    tokens = (*map(_with_room, lifting.tokens), goal, *walls)
    return Task(
        f"carry_{seed}",
        DOMAIN,
        tokens,
        State.of(tokens, given),
        (Atom("inside", ("box", "goal")), Atom("stands", ("box",))),
        agents=lifting.agents,
        seed=seed,
    )


def _with_room(token: Token) -> Token:
    """Return a hand with a larger workspace, or another token as it is."""
    if not token.basic_actions:
        return token
    room = {"workspace_lower": (-_REACH, -_REACH, 0.0), "workspace_upper": (_REACH, _REACH, 1.5)}
    return Token.make(token.name, list(token.classes), {**token.properties, **room})
