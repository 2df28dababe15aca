"""Small random tasks of tumbling: two or four hands turn a box about one or two axes."""

from collections.abc import Sequence

import numpy as np
from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from hybrid_tamp_domains.rolling_tumbling.classes import Tumblable
from numpy.typing import ArrayLike

from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.skills import StaticEndEffector

KINDS = (
    "twice",
    "slender, about two axes",
    "about another axis",
    "twice",
    "too heavy",
    "slender, about two axes",
    "same side",
    "twice",
    "slender, about two axes",
    "out of reach",
    "once",
    "mixed pair",
)
_LEVEL = {"x": (0.0, np.pi / 2, 0.0), "y": (np.pi / 2, 0.0, 0.0)}
"""Maps each axis of a hand to its roll, pitch and yaw [rad]."""
_FACES = {"y": ("right", "left"), "x": ("back", "front")}
"""Maps the axis of the hands to the faces onto which they tumble a box."""


def small_tumbling(seed: int, kind: str, rng: np.random.Generator) -> Task:
    """Return a task in which hands tumble a box onto a face."""
    axis = str(rng.choice(("x", "y")))
    other = "x" if axis == "y" else "y"
    two_axes = kind.startswith("slender")
    extents = slender(rng, axis) if two_axes else cubelike(rng)
    face = str(rng.choice(_FACES[axis]))
    face = {"twice": "top", "about another axis": str(rng.choice(_FACES[other]))}.get(kind, face)
    four = two_axes or (kind in ("once", "twice", "too heavy", "out of reach") and rng.random() < 0.4)
    force = rng.uniform(20.0, 50.0) if kind == "too heavy" else 300.0
    room = 0.3 if kind == "out of reach" else 1.5
    axes = [axis, axis, *((other, other) if four else ())]
    if kind == "mixed pair":
        axes = [axis, other]
    name = f"proof_{seed}_tumbling_{kind.replace(', ', '_').replace(' ', '_')}"
    task = tumbling_task(name, seed, rng, random_box(rng, "box", extents), axes, face, force, room)
    if kind != "same side":
        return task
    first, beside = task.state["hand 1", "position"], np.array([0.0, 0.0, 0.25])
    return task.replaced(state=task.state.replace({("hand 2", "position"): first + beside}))


def tumbling_task(
    name: str,
    seed: int,
    rng: np.random.Generator,
    box: Token,
    axes: Sequence[str],
    face: str,
    force: float = 300.0,
    room: float = 1.5,
) -> Task:
    """Return a task in which hands tumble a box onto a face. The box is displaced by up to 2 cm and 3 degrees.

    Args:
        name: name of the task.
        seed: seed of all random numbers in planning.
        rng: generator of the place of the box.
        box: the box.
        axes: axis of each hand. Hands alternate between the two sides of the box.
        face: face on which the box must lie in the end.
        force: maximal force of each hand [N].
        room: height of the workspaces [m].
    """
    hands = [tumbler(f"hand {number + 1}", force, room) for number in range(len(axes))]
    given: dict[tuple[str, str], ArrayLike] = {
        ("box", "position"): (*rng.uniform(-0.02, 0.02, 2), box["half_extents"][2]),
        ("box", "orientation"): quaternion_from_rpy(np.array([0.0, 0.0, np.radians(rng.uniform(-3.0, 3.0))])),
    }
    for number, (hand, own) in enumerate(zip(hands, axes, strict=True)):
        away, height = 0.62 if number % 2 else -0.62, min(0.55, room - 0.02)
        given[hand.name, "position"] = (away, 0.0, height) if own == "y" else (0.0, away, height)
        given[hand.name, "orientation"] = quaternion_from_rpy(np.array(_LEVEL[own]))
    tokens = (*hands, box)
    return Task(name, DOMAIN, tokens, State.of(tokens, given), (Atom("posture", ("box", f"flat {face}")),), seed=seed)


def cubelike(rng: np.random.Generator) -> tuple[float, float, float]:
    """Return edge lengths [m] with ratios of at most 1.5."""
    short = rng.uniform(0.22, 0.26)
    x, y, z = rng.uniform(short, 1.5 * short, 3)
    return float(x), float(y), float(z)


def slender(rng: np.random.Generator, axis: str) -> tuple[float, float, float]:
    """Return edge lengths [m] of a box that is initially too slender to be tumbled about one of the axes.

    After a tumble about the other axis, the box is less slender in this direction.
    """
    short = rng.uniform(0.21, 0.23)
    high, wide = short * rng.uniform(1.65, 1.75), short * rng.uniform(1.15, 1.3)
    return (float(short), float(wide), float(high)) if axis == "y" else (float(wide), float(short), float(high))


def random_box(rng: np.random.Generator, name: str, extents: tuple[float, float, float]) -> Token:
    """Return a box with edge lengths [m], mass U(8, 14) kg and friction U(0.5, 0.9)."""
    properties = {
        "half_extents": tuple(extent / 2 for extent in extents),
        "mass": float(rng.uniform(8.0, 14.0)),
        "friction": float(rng.uniform(0.5, 0.9)),
    }
    return Token.make(name, [Tumblable], properties)


def tumbler(name: str, force: float = 300.0, room: float = 1.5) -> Token:
    """Return a hand with a maximal force [N] and a workspace of a height `room` [m]."""
    properties = {
        "radius": 0.035,
        "length": 0.16,
        "mass": 1.5,
        "maximal_force": float(force),
        "workspace_lower": (-2.0, -2.0, 0.0),
        "workspace_upper": (2.0, 2.0, float(room)),
    }
    return Token.make(name, [StaticEndEffector], properties)
