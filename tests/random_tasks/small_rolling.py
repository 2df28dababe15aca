"""Small random tasks of rolling: several regions, one or two hands with limited workspaces, one or two drums."""

from collections.abc import Sequence

import numpy as np
from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from hybrid_tamp_domains.rolling_tumbling.classes import Rollable
from numpy.typing import ArrayLike

from hybrid_tamp.geometry.shapes import Cylinder
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.skills import Region, StaticEndEffector

KINDS = (
    "relay",
    "off the line",
    "relay",
    "relay without a region",
    "relay",
    "upright",
    "relay",
    "relay without the far hand",
    "direct",
    "two drums",
)
Given = dict[tuple[str, str], ArrayLike]


def small_rolling(seed: int, kind: str, rng: np.random.Generator) -> Task:
    """Return a task in which hands roll drums. In the kind ``relay``, two hands roll the drum in turn."""
    # The workspaces are aligned with the world, so a relay rolls along x or y.
    yaw = float(rng.choice(np.pi / 2 * np.arange(4)) if "relay" in kind else rng.uniform(-np.pi, np.pi))
    along, aside = np.array([np.cos(yaw), np.sin(yaw), 0.0]), np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    tokens, given = list[Token](), Given()
    drum = random_drum(rng, "drum")
    start = along * rng.uniform(-0.05, 0.05)
    place_drum(given, drum, start, yaw, upright=kind == "upright")
    far = start + along * (rng.uniform(0.9, 1.2) if "relay" in kind else rng.uniform(0.3, 0.8))
    middle = start + (far - start) * rng.uniform(0.45, 0.55)
    if kind == "off the line":
        far = far + aside * rng.uniform(0.1, 0.3) * rng.choice((-1.0, 1.0))
    regions = [("goal", far), ("decoy", far + aside * rng.uniform(0.4, 0.6))]
    if kind in ("relay", "relay without the far hand", "direct", "off the line"):
        regions.append(("middle", middle))
    tokens.append(drum)
    goal = [Atom("inside", ("drum", "goal"))]
    if kind == "two drums":
        other = random_drum(rng, "other")
        place_drum(given, other, start + aside * 0.8, yaw, upright=False)
        tokens.append(other)
        regions[1] = ("decoy", far + aside * 0.8)
        goal.append(Atom("inside", ("other", "decoy")))
    for name, place in regions:
        tokens.append(Token.make(name, [Region], {"radius": float(rng.uniform(0.02, 0.06))}))
        given[name, "position"] = place * np.array([1.0, 1.0, 0.0])
    hands = relay_hands(rng, along, start, middle, far)
    if "relay" not in kind:
        above = np.array([0.0, 0.0, rng.uniform(0.2, 0.5)])
        hands = [(roller("hand"), start - along * rng.uniform(0.5, 0.8) + above)]
    for hand, place in hands[:1] if kind == "relay without the far hand" else hands:
        tokens.append(hand)
        given[hand.name, "position"] = place
    name = f"proof_{seed}_rolling_{kind.replace(' ', '_')}"
    return Task(name, DOMAIN, tuple(tokens), State.of(tokens, given), tuple(goal), seed=seed)


def random_drum(rng: np.random.Generator, name: str) -> Token:
    """Return a drum: radius U(0.06, 0.15) m, length U(0.2, 0.4) m, mass U(2, 12) kg, friction U(0.4, 0.9)."""
    radius = float(rng.uniform(0.06, 0.15))
    properties = {
        "axis_of_rotation": (0.0, 0.0, 1.0),
        "radius_of_rotation": radius,
        "mass": float(rng.uniform(2.0, 12.0)),
        "friction": float(rng.uniform(0.4, 0.9)),
    }
    shape = Cylinder(kind="cylinder", radius=radius, length=float(rng.uniform(0.2, 0.4)))
    return Token.make(name, [Rollable], properties, shape)


def place_drum(given: Given, drum: Token, start: FloatArray, yaw: float, upright: bool = False) -> None:
    """Place a drum so that it rolls along the heading `yaw` [rad], or stands on its end."""
    shape = drum.shape
    assert isinstance(shape, Cylinder), "a drum must be a cylinder"
    height = shape.length / 2 if upright else shape.radius
    given[drum.name, "position"] = start + np.array([0.0, 0.0, height])
    given[drum.name, "orientation"] = quaternion_from_rpy(np.array([0.0 if upright else np.pi / 2, 0.0, yaw]))


def roller(name: str, lower: Sequence[float] = (-3.0, -3.0, 0.0), upper: Sequence[float] = (3.0, 3.0, 1.2)) -> Token:
    """Return a hand with a workspace [m]."""
    properties = {
        "radius": 0.035,
        "length": 0.16,
        "mass": 1.5,
        "maximal_force": 300.0,
        "workspace_lower": tuple(map(float, lower)),
        "workspace_upper": tuple(map(float, upper)),
    }
    return Token.make(name, [StaticEndEffector], properties)


def relay_hands(
    rng: np.random.Generator, along: FloatArray, start: FloatArray, middle: FloatArray, far: FloatArray
) -> list[tuple[Token, FloatArray]]:
    """Return two hands with workspaces: from behind the start to the middle, and from the middle to the end."""
    first = _between(start - along, middle + along * rng.uniform(-0.05, 0.05), along)
    second = _between(middle - along * rng.uniform(0.3, 0.32), far + along, along)
    height = np.array([0.0, 0.0, 0.4])
    return [
        (roller("near hand", *first), start - along * 0.7 + height),
        (roller("far hand", *second), far + along * 0.3 + height),
    ]


def _between(one: FloatArray, other: FloatArray, along: FloatArray) -> tuple[tuple[float, ...], tuple[float, ...]]:
    aside = np.abs(np.array([along[1], along[0], 0.0]))
    lower, upper = np.minimum(one, other) - aside, np.maximum(one, other) + aside
    return (*lower[:2].tolist(), 0.0), (*upper[:2].tolist(), 1.2)
