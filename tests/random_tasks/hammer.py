"""Tasks with a hammer for trials and figures, with a given or a random scene."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from hybrid_tamp_domains.tool_use import DOMAIN
from hybrid_tamp_domains.tool_use.classes import DexterousHand, Pushable, Pusher, Strikable, Striker

from hybrid_tamp.geometry.shapes import BoxPart, Compound, SpherePart
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy, rotate
from hybrid_tamp.skills import Region, standing_height
from random_tasks.corners import Corner

HAND = {
    "radius": 0.03,
    "length": 0.08,
    "mass": 1.5,
    "maximal_force": 300.0,
    "workspace_lower": (-3.0, -3.0, 0.0),
    "workspace_upper": (3.0, 3.0, 1.5),
    "maximal_torque": 10.0,
    "maximal_grip": 200.0,
    "wrist_inertia": 0.002,
    "contact_width": 0.06,
    "strike_torque": 4.0,
    "strike_angle": np.pi / 2,
}
HAMMER = {
    "mass": 0.6,
    "friction": 0.2,
    "inertia": (0.0003, 0.00199, 0.00199),
    "handle_from": (-0.15, 0.0, 0.0),
    "handle_to": (0.0, 0.0, 0.0),
    "handle_width": 0.03,
    "impact_point": (0.025, 0.0, -0.045),
    "pushing_point": (0.025, 0.0, 0.045),
}
_HALF_EXTENTS = (0.02, 0.06, 0.06)
_DISTANCES = (0.1, 1.0)


def hammer_shape() -> Compound:
    """Return a handle and a head with two domed faces."""
    return Compound(
        kind="compound",
        parts=(
            BoxPart(kind="box", half_extents=(0.1, 0.012, 0.012), position=(-0.075, 0.0, 0.0)),
            BoxPart(kind="box", half_extents=(0.015, 0.02, 0.03), position=(0.025, 0.0, 0.0)),
            SpherePart(kind="sphere", radius=0.0145, position=(0.025, 0.0, 0.0305)),
            SpherePart(kind="sphere", radius=0.0145, position=(0.025, 0.0, -0.0305)),
        ),
    )


@dataclass(frozen=True)
class Scene:
    """Initial scene of a task with a hammer. Angles are about the vertical.

    Attributes:
        start: initial position of the block ``(x, y)`` [m].
        end: position to which the block is pushed and where it is struck [m].
        rack: position of the hammer [m].
        facing: heading of the hammer [rad].
        hand: position of the hand ``(x, y, z)`` [m].
        mass: mass of the block [kg].
        friction: friction of the block.
    """

    start: Sequence[float] = (0.1, 0.0)
    end: Sequence[float] = (0.5, 0.0)
    rack: Sequence[float] = (-0.25, 0.0)
    facing: float = 0.0
    hand: Sequence[float] = (-0.3, -0.3, 0.3)
    mass: float = 2.0
    friction: float = 0.5


def hammer_task(name: str, scene: Scene, goal: Sequence[str] = ("push", "strike"), seed: int = 0) -> Task:
    """Return a task in which a hand pushes and strikes a block with a hammer, and puts the hammer back.

    Args:
        name: name of the task.
        scene: initial scene.
        goal: ``push``, ``strike``, or both.
        seed: seed of all random numbers in planning.
    """
    hand = Token.make("hand", [DexterousHand], HAND)
    hammer = Token.make("hammer", [Striker, Pusher], HAMMER, hammer_shape())
    own = {"half_extents": _HALF_EXTENTS, "mass": scene.mass, "friction": scene.friction, "impulse_needed": 0.5}
    block = Token.make("block", [Pushable, Strikable], own)
    regions = [Token.make(each, [Region], {"radius": 0.03}) for each in ("goal", "rack")]
    tokens = (hand, hammer, block, *regions)
    heading = np.arctan2(scene.end[1] - scene.start[1], scene.end[0] - scene.start[0])
    atoms = {"push": Atom("inside", ("block", "goal")), "strike": Atom("struck", ("block",))}
    state = State.of(
        tokens,
        {
            ("hand", "position"): scene.hand,
            ("hand", "orientation"): quaternion_from_rpy((np.pi / 2, 0.0, scene.facing)),
            ("hammer", "position"): (*scene.rack, standing_height(hammer)),
            ("hammer", "orientation"): quaternion_from_rpy((0.0, np.pi / 2, scene.facing)),
            ("block", "position"): (*scene.start, _HALF_EXTENTS[2]),
            ("block", "orientation"): quaternion_from_rpy((0.0, 0.0, heading)),
            ("goal", "position"): (*scene.end, 0.0),
            ("rack", "position"): (*scene.rack, 0.0),
        },
    )
    return Task(name, DOMAIN, tokens, state, (*(atoms[each] for each in goal), Atom("empty", ("hand",))), seed=seed)


def random_hammer(seed: int, rng: np.random.Generator | Corner | None = None) -> Task:
    """Return a task in which a hand pushes a block to a region with a hammer and strikes it there.

    Distance U(0.1, 1.0) m in any direction, mass U(1, 3) kg, friction U(0.4, 0.6). The hammer stands 0.3 to 0.5 m
    behind the block and up to 0.3 m to the side, with any heading. The hand starts within 0.3 m of the hammer.
    """
    rng = rng or np.random.default_rng(seed)
    heading, distance = rng.uniform(-np.pi, np.pi), rng.uniform(*_DISTANCES)
    turn = quaternion_from_rpy((0.0, 0.0, heading))
    end = rotate(turn, (distance, 0.0, 0.0))
    rack = rotate(turn, (-rng.uniform(0.3, 0.5), rng.uniform(-0.3, 0.3), 0.0))
    beside = rng.uniform(-np.pi, np.pi)
    away = rng.uniform(0.15, 0.3)
    hand = (rack[0] + away * np.cos(beside), rack[1] + away * np.sin(beside), rng.uniform(0.15, 0.4))
    scene = Scene(
        start=(0.0, 0.0),
        end=tuple(end[:2]),
        rack=tuple(rack[:2]),
        facing=rng.uniform(-np.pi, np.pi),
        hand=hand,
        mass=rng.uniform(1.0, 3.0),
        friction=rng.uniform(0.4, 0.6),
    )
    return hammer_task(f"hammer_{seed}", scene, seed=seed)
