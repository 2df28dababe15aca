"""A workbench for tests of physics: a hand with a wrist and two virtual fingers, a hammer, and an impulse sensor."""

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from hybrid_tamp.geometry.shapes import Box, BoxPart, Compound, Sphere, SpherePart
from hybrid_tamp.model.affordance import (
    BODY_STATE,
    TOKEN,
    AffordanceClass,
    BasicAction,
    CapabilityClass,
    VaryingProperty,
    Vector3,
    quantity,
)
from hybrid_tamp.model.block import Block, Duration, Slot
from hybrid_tamp.model.control import Commands
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.grasp import aperture_property
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.motion.poses import quaternion_conjugate, quaternion_from_rpy, rotate, rotation_vector
from hybrid_tamp.physics.bullet.backend import BulletBackend

MASS, MOMENT, WRIST = 0.6, 0.00199, 0.002
OPENED, WIDTH, NEARLY = 0.08, 0.024, 0.0245
FIRM, WEAK = 150.0, 5.0
HAMMER = Compound(
    kind="compound",
    parts=(
        BoxPart(kind="box", half_extents=(0.1, 0.012, 0.012), position=(-0.075, 0.0, 0.0)),
        BoxPart(kind="box", half_extents=(0.015, 0.02, 0.03), position=(0.025, 0.0, 0.0)),
        SpherePart(kind="sphere", radius=0.0145, position=(0.025, 0.0, 0.0305)),
        SpherePart(kind="sphere", radius=0.0145, position=(0.025, 0.0, -0.0305)),
    ),
)
ON_ITS_HEAD = quaternion_from_rpy([0.0, np.pi / 2, 0.0])
HANDLE_UP = quaternion_from_rpy([0.0, -np.pi / 2, 0.0])
FORWARD, LEFT, UP = np.eye(3)


class Hand(CapabilityClass):
    """A hand that grips."""

    name: ClassVar[str] = "HAND"
    varying: ClassVar[tuple[VaryingProperty, ...]] = (*BODY_STATE, aperture_property(OPENED))
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (
        BasicAction("force", 3, "N"),
        BasicAction("torque", 3, "N m", "maximal_torque"),
        BasicAction("grip", 1, "N", "maximal_grip"),
    )
    mass: float = quantity("kg", "mass")
    maximal_torque: float = quantity("N m", "largest torque", default=20.0)
    maximal_grip: float = quantity("N", "largest grip", default=200.0)
    maximal_aperture: float = quantity("m", "largest gap", default=OPENED)
    wrist_inertia: float = quantity("kg m2", "rotational inertia", default=WRIST)


class Clumsy(CapabilityClass):
    """A hand with a torque and a grip, but without the properties that these actions need."""

    name: ClassVar[str] = "CLUMSY"
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (BasicAction("torque", 3, "N m"), BasicAction("grip", 1, "N"))


class Stiff(CapabilityClass):
    """A hand with a grip, but without a wrist that turns."""

    name: ClassVar[str] = "STIFF"
    varying: ClassVar[tuple[VaryingProperty, ...]] = (*BODY_STATE, aperture_property(OPENED))
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (
        BasicAction("force", 3, "N"),
        BasicAction("grip", 1, "N", "maximal_grip"),
    )
    mass: float = quantity("kg", "mass")
    maximal_grip: float = quantity("N", "largest grip", default=200.0)
    maximal_aperture: float = quantity("m", "largest gap", default=OPENED)


class Tool(AffordanceClass):
    """A tool with a handle."""

    name: ClassVar[str] = "TOOL"
    mass: float = quantity("kg", "mass")
    inertia: Vector3 = quantity("kg m2", "principal moments", default=(0.0004, MOMENT, 0.0022))
    handle_from: Vector3 = quantity("m", "one end", default=(-0.15, 0.0, 0.0))
    handle_to: Vector3 = quantity("m", "the other end", default=(0.0, 0.0, 0.0))
    handle_width: float = quantity("m", "width", default=WIDTH)


class Thing(AffordanceClass):
    """A body that records the impulse on it."""

    name: ClassVar[str] = "THING"
    varying: ClassVar[tuple[VaryingProperty, ...]] = (*BODY_STATE, VaryingProperty("impulse", 1, "N s", (0.0,)))
    mass: float = quantity("kg", "mass")
    friction: float = quantity("1", "friction", default=0.5)


DOMAIN = Domain(
    name="bench",
    classes=(Hand, Clumsy, Stiff, Tool, Thing),
    disjoint=((Hand, Clumsy, Stiff),),
    predicates=(),
    blocks=(Block("RESTING", (Slot("token", TOKEN),), "token", Duration(0.1, 60.0, lambda *_: 0.1), hold=True),),
    network=ReassignmentNetwork([("RESTING.token", "RESTING.token")]),
)
Policy = Callable[[float, State], Commands]


def scene(given: dict[tuple[str, str], Any], **things: Token) -> Task:
    tokens = tuple(things.values())
    return Task("bench", DOMAIN, tokens, State.of(tokens, given), ())


def ball(name: str, kind: type[Any], **properties: float) -> Token:
    return Token.make(name, [kind], properties, Sphere(kind="sphere", radius=0.03))


def block(mass: float = 2.0, friction: float = 0.5) -> Token:
    return Token.make(
        "block", [Thing], {"mass": mass, "friction": friction}, Box(kind="box", half_extents=(0.1, 0.1, 0.05))
    )


def held(grasp: float, turn: FloatArray, at: FloatArray = UP, aperture: float = NEARLY, **things: Token) -> Task:
    """Return a scene with nearly closed fingers around the handle of a hammer, `grasp` [m] from the centre of mass."""
    tokens = {
        "hand": ball("hand", Hand, mass=1.0),
        "hammer": Token.make("hammer", [Tool], {"mass": MASS}, HAMMER),
        **things,
    }
    centre = at + rotate(turn, np.array([grasp, 0.0, 0.0]))
    given: dict[tuple[str, str], Any] = {("hammer", "position"): centre, ("hammer", "orientation"): turn}
    given |= {("hand", "position"): at, ("hand", "aperture"): aperture}
    return scene(given | ({("block", "position"): (0.15, 0.0, 0.05)} if "block" in things else {}), **tokens)


def run(task: Task, seconds: float, policy: Policy) -> list[State]:
    with BulletBackend() as backend:
        states = [backend.reset(task, task.state)]
        for step in range(round(seconds / backend.timestep)):
            states.append(backend.step(policy(step * backend.timestep, states[-1])))
    return states


def upright(
    state: State, place: FloatArray, grip: float, speed: FloatArray | float = 0.0, stiffness: float = 40.0
) -> Commands:
    """Return the commands of a pose servo that bears the hammer's weight, and is stable for a hand without a tool."""
    force = 8000 * (place - state["hand", "position"]) + 180 * (speed - state["hand", "velocity"])
    off = rotation_vector(state["hand", "orientation"])
    torque = -stiffness * (off + 0.008 * state["hand", "angular_velocity"])
    return {
        ("hand", "force"): force + MASS * GRAVITY * UP,
        ("hand", "torque"): torque,
        ("hand", "grip"): np.array([grip]),
    }


def grasp_point(state: State) -> FloatArray:
    """Return the hand's position in the hammer's frame [m]."""
    offset = state["hand", "position"] - state["hammer", "position"]
    return rotate(quaternion_conjugate(state["hammer", "orientation"]), offset)
