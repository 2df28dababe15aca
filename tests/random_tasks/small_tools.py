"""Small random tasks with a hammer: pushes between several regions, and strikes."""

from collections.abc import Mapping, Sequence

import numpy as np
from hybrid_tamp_domains.tool_use import DOMAIN
from hybrid_tamp_domains.tool_use.classes import DexterousHand, Pushable, Pusher, Strikable, Striker
from numpy.typing import ArrayLike

from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import MidLevel, Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rpy, rotate
from hybrid_tamp.skills import Region, standing_height
from random_tasks.hammer import HAMMER, HAND, hammer_shape

KINDS = (
    "corner",
    "no corner",
    "corner and strike",
    "push",
    "too weak",
    "corner",
    "corner and strike",
    "lying tool",
    "strike",
    "corner",
    "out of reach",
    "corner and strike",
    "two blocks",
)
_HALF = 0.06
QUICK = MidLevel(
    evaluations=100,
    hyperparameters={"REACHING.duration": 2.2, "CARRYING.duration": 2.4, "PUSHING.beyond": 0.0},
)
"""Settings with which the optimisation takes little time."""


def small_tools(seed: int, kind: str, rng: np.random.Generator) -> Task:
    """Return a task in which a hand pushes or strikes a block with a hammer, and sets the hammer down."""
    yaw = float(rng.uniform(-np.pi, np.pi))
    ahead, aside = rng.uniform(0.2, 0.4), rng.uniform(0.2, 0.4) * rng.choice((-1.0, 1.0))
    corner = "corner" in kind
    places = {"goal": turned(yaw, (ahead, aside)) if corner else turned(yaw, (ahead, 0.0))}
    if corner and kind != "no corner":
        places["middle"] = turned(yaw, (ahead, 0.0) if rng.random() < 0.5 else (0.0, aside))
    if corner or rng.random() < 0.5:
        skew = rng.uniform(0.3, 0.6) * np.array([np.cos(np.radians(25.0)), np.sin(np.radians(25.0))])
        places["decoy"] = turned(yaw, -skew)
    wanted = [Atom("inside", ("block", "goal"))] if kind != "strike" else []
    wanted += [Atom("struck", ("block",))] if "strike" in kind else []
    blocks = {"block": (np.zeros(2), yaw)}
    if kind == "two blocks":
        blocks["other"] = (turned(yaw, (0.0, 0.6)), yaw)
        places["middle"] = turned(yaw, (ahead, 0.6))
        wanted.append(Atom("inside", ("other", "middle")))
    hand: dict[str, object] = {}
    if kind == "too weak":
        hand = {"maximal_torque": 0.09, "strike_torque": 0.05}
    if kind == "out of reach":
        hand = {"workspace_lower": (-0.8, -0.8, 0.0), "workspace_upper": (0.8, 0.8, 1.5)}
        places["goal"] = turned(yaw, (1.3, 0.0))
    task = hammer_scene(
        f"proof_{seed}_tools_{kind.replace(' ', '_')}",
        seed,
        blocks,
        places,
        wanted,
        rack=turned(yaw, (-rng.uniform(0.3, 0.4), rng.uniform(0.15, 0.25))),
        facing=float(rng.uniform(-np.pi, np.pi)),
        hand=hand,
        mass=float(rng.uniform(1.0, 2.5)),
    )
    return _laid_down(task) if kind == "lying tool" else task


def turned(yaw: float, place: Sequence[float] | FloatArray) -> FloatArray:
    """Return a position ``(2,)`` [m], rotated about the origin."""
    return rotate(quaternion_from_rpy(np.array([0.0, 0.0, yaw])), np.array([*place, 0.0]))[:2]


def hammer_scene(
    name: str,
    seed: int,
    blocks: Mapping[str, tuple[FloatArray, float]],
    places: Mapping[str, Sequence[float] | FloatArray],
    goal: Sequence[Atom],
    *,
    rack: Sequence[float] | FloatArray,
    facing: float = 0.0,
    hand: Mapping[str, object] | None = None,
    mass: float = 2.0,
) -> Task:
    """Return a task with a hand, a hammer, blocks and regions. In the end, the hand must be empty.

    Args:
        name: name of the task.
        seed: seed of all random numbers in planning.
        blocks: maps each block to its position ``(2,)`` [m] and its yaw [rad].
        places: maps each region to its position ``(2,)`` [m].
        goal: wanted atoms.
        rack: initial position ``(2,)`` [m] of the hammer.
        facing: heading of the hammer [rad].
        hand: properties of the hand that differ from the default properties.
        mass: mass of each block [kg].
    """
    hammer = Token.make("hammer", [Striker, Pusher], HAMMER, hammer_shape())
    own = {"half_extents": (0.02, _HALF, _HALF), "mass": mass, "friction": 0.5, "impulse_needed": 0.4}
    tokens = [Token.make("hand", [DexterousHand], {**HAND, **(hand or {})}), hammer]
    tokens += [Token.make(each, [Pushable, Strikable], own) for each in blocks]
    tokens += [Token.make(each, [Region], {"radius": 0.03}) for each in (*places, "rack")]
    given: dict[tuple[str, str], ArrayLike] = {
        ("hand", "position"): (rack[0] + 0.15, rack[1] - 0.15, 0.3),
        ("hand", "orientation"): quaternion_from_rpy((np.pi / 2, 0.0, facing)),
        ("hammer", "position"): (*rack, standing_height(hammer)),
        ("hammer", "orientation"): quaternion_from_rpy((0.0, np.pi / 2, facing)),
        ("rack", "position"): (*rack, 0.0),
    }
    for block, (place, yaw) in blocks.items():
        given[block, "position"] = (*place, _HALF)
        given[block, "orientation"] = quaternion_from_rpy((0.0, 0.0, yaw))
    given |= {(each, "position"): (*place, 0.0) for each, place in places.items()}
    wanted = (*goal, Atom("empty", ("hand",)))
    return Task(name, DOMAIN, tuple(tokens), State.of(tokens, given), wanted, seed=seed, midlevel=QUICK)


def _laid_down(task: Task) -> Task:
    lying = {("hammer", "orientation"): quaternion_from_rpy((np.pi / 2, 0.0, 0.0))}
    place = (*task.state["hammer", "position"][:2], 0.021)
    return task.replaced(state=task.state.replace({**lying, ("hammer", "position"): place}))
