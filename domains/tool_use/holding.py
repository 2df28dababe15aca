"""A hand and the tool that it holds, as one rigid body: what moves it, and how it moves.

With r from the hand to the tool's centre of mass, the hand at x, the tool at x + r and f the force that the hand
exerts on the tool (Newton and Euler)::

    m_hand x'' = F - f,     m (x + r)'' = f + w,     (I + I_wrist) alpha = T - r x f + n

F and T are the basic actions, w and n the other forces on the tool and their moment: its weight, and what it touches.
The body turns about the tool's y axis, so (x + r)'' = x'' + alpha x r - omega^2 r, and I is the moment about that axis;
turns about the others are slow, and the same moment serves there. The hand's own weight is compensated.
"""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.authoring import (
    CAPTURE,
    FINGER_SPEED,
    GRAVITY,
    Commands,
    FloatArray,
    State,
    Token,
    cross,
    quaternion_from_rotation_vector,
    quaternion_multiply,
    rotate,
)

from ..common.servos import DAMPING_RATIO, turning_rate
from .geometry import UP, dot, off_handle

_LIFT = GRAVITY * UP
"""What compensates gravity [m/s^2]."""
POSITION_RATE = 60.0
"""Natural frequency with which a hand and its tool come to a place [rad/s]."""


@dataclass(frozen=True, eq=False)
class Load:
    """What acts on a held tool beside the hand and its weight.

    Attributes:
        force: ``(..., 3)`` [N].
        point: where it acts ``(..., 3)`` [m].
    """

    force: FloatArray
    point: FloatArray


def wrench(
    state: State,
    hand: Token,
    tool: Token,
    acceleration: FloatArray,
    turning: FloatArray,
    load: Load | None = None,
) -> Commands:
    """Return the basic actions that accelerate the hand and its tool as wanted (inverse dynamics).

    Args:
        state: current state.
        hand: the hand.
        tool: the tool that it holds.
        acceleration: of the hand, ``(..., 3)`` [m/s^2].
        turning: angular acceleration of both, ``(..., 3)`` [rad/s^2].
        load: what acts on the tool beside, or None.
    """
    arm = state[tool, "position"] - state[hand, "position"]
    spin = state[tool, "angular_velocity"]
    moving = acceleration + cross(turning, arm) - dot(spin, spin)[..., None] * arm
    force = tool["mass"] * (moving + _LIFT)
    torque = (tool["inertia"][1] + hand["wrist_inertia"]) * turning
    if load is not None:
        force = force - load.force
        torque = torque - cross(load.point - state[tool, "position"], load.force)
    return {
        (hand.name, "force"): hand["mass"] * acceleration + force,
        (hand.name, "torque"): torque + cross(arm, force),
        (hand.name, "grip"): np.full((*arm.shape[:-1], 1), hand["maximal_grip"]),
    }


def servo(
    state: State,
    hand: Token,
    tool: Token,
    position: tuple[FloatArray, FloatArray],
    orientation: tuple[FloatArray, FloatArray],
    load: Load | None = None,
) -> Commands:
    """Return the basic actions that keep a hand and its tool on a moving reference.

    Args:
        state: current state.
        hand: the hand.
        tool: the tool that it holds.
        position: of the hand [m] and its velocity [m/s], each ``(..., 3)``.
        orientation: of the tool ``(..., 4)`` and its angular velocity ``(..., 3)`` [rad/s].
        load: what acts on the tool beside, or None.
    """
    return wrench(state, hand, tool, keeping(state, hand, *position), turning_rate(state, tool, *orientation), load)


def keeping(
    state: State,
    hand: Token,
    position: FloatArray,
    velocity: FloatArray | float,
    acceleration: FloatArray | float = 0.0,
) -> FloatArray:
    """Return the acceleration ``(..., 3)`` [m/s^2] that brings a hand back to a moving reference."""
    error, drift = position - state[hand, "position"], velocity - state[hand, "velocity"]
    return np.asarray(acceleration + POSITION_RATE**2 * error + 2.0 * DAMPING_RATIO * POSITION_RATE * drift)


def accelerated(state: State, hand: Token, tool: Token, commands: Commands, dt: float) -> tuple[FloatArray, FloatArray]:
    """Return the velocity of the hand [m/s] and the angular velocity of both [rad/s], each ``(..., 3)``, after a step.

    They move as one rigid body by what is commanded and by the tool's weight.
    """
    arm = state[tool, "position"] - state[hand, "position"]
    spin = state[tool, "angular_velocity"]
    pushed = commands[hand.name, "force"] / hand["mass"] + _LIFT
    reduced = tool["mass"] * hand["mass"] / (tool["mass"] + hand["mass"])
    inertia = tool["inertia"][1] + hand["wrist_inertia"] + reduced * dot(arm, arm)
    turning = (commands[hand.name, "torque"] - reduced * cross(arm, pushed)) / inertia[..., None]
    force = reduced * (pushed + cross(turning, arm) - dot(spin, spin)[..., None] * arm)
    return state[hand, "velocity"] + (commands[hand.name, "force"] - force) * (dt / hand["mass"]), spin + turning * dt


def moved(state: State, hand: Token, tool: Token, commands: Commands, dt: float) -> dict[tuple[str, str], FloatArray]:
    """Return how hand and tool change in one step as one rigid body (semi-implicit Euler, exact turns)."""
    return placed(state, hand, tool, *accelerated(state, hand, tool, commands, dt), dt)


def placed(
    state: State, hand: Token, tool: Token, velocity: FloatArray, spin: FloatArray, dt: float
) -> dict[tuple[str, str], FloatArray]:
    """Return where hand and tool are after a step at a velocity of the hand and an angular velocity of both."""
    turn = quaternion_from_rotation_vector(spin * dt)
    arm = rotate(turn, state[tool, "position"] - state[hand, "position"])
    position = state[hand, "position"] + velocity * dt
    return {
        (hand.name, "position"): position,
        (hand.name, "velocity"): velocity,
        (hand.name, "orientation"): quaternion_multiply(turn, state[hand, "orientation"]),
        (hand.name, "angular_velocity"): spin,
        (tool.name, "position"): position + arm,
        (tool.name, "velocity"): velocity + cross(spin, arm),
        (tool.name, "orientation"): quaternion_multiply(turn, state[tool, "orientation"]),
        (tool.name, "angular_velocity"): spin,
    }


def fingers(state: State, hand: Token, tool: Token, commands: Commands, dt: float) -> dict[tuple[str, str], FloatArray]:
    """Return how the fingers move in one step: closing they stop at a handle between them."""
    gap = state[hand, "aperture"]
    closing = commands.get((hand.name, "grip"), np.zeros_like(gap)) > 0
    between = (off_handle(state, hand, tool) <= CAPTURE)[..., None]
    narrowest = np.where(between & (gap >= tool["handle_width"]), tool["handle_width"], 0.0)
    closed = np.maximum(gap - FINGER_SPEED * dt, narrowest)
    opened = np.minimum(gap + FINGER_SPEED * dt, hand["maximal_aperture"])
    return {(hand.name, "aperture"): np.where(closing, closed, opened)}


Whole = tuple[FloatArray, float, FloatArray]
"""Centre of mass ``(..., 3)`` [m], mass [kg] and moment of inertia ``(...)`` [kg m^2] of hand and tool."""


def whole(state: State, hand: Token, tool: Token) -> Whole:
    """Return hand and tool as one body."""
    arm = state[tool, "position"] - state[hand, "position"]
    mass = hand["mass"] + tool["mass"]
    reduced = tool["mass"] * hand["mass"] / mass
    inertia = tool["inertia"][1] + hand["wrist_inertia"] + reduced * dot(arm, arm)
    return state[hand, "position"] + arm * (tool["mass"] / mass), float(mass), inertia


def effective_mass(body: Whole, at: FloatArray, direction: FloatArray) -> FloatArray:
    """Return the mass ``(...)`` [kg] with which hand and tool meet a blow at a point along a unit direction.

    A blow P at distance l from the common centre of mass changes the point's speed by P (1/M + l^2/I).
    """
    centre, mass, inertia = body
    lever = cross(at - centre, direction)
    return np.asarray(1.0 / (1.0 / mass + dot(lever, lever) / inertia))


def knocked(
    body: Whole, velocity: FloatArray, spin: FloatArray, place: FloatArray, at: FloatArray, blow: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return velocity of the hand, which is at a place, and angular velocity of both after a blow on the tool.

    Args:
        body: hand and tool.
        velocity: of the hand before, ``(..., 3)`` [m/s].
        spin: of both before, ``(..., 3)`` [rad/s].
        place: of the hand, ``(..., 3)`` [m].
        at: where the blow meets the tool, ``(..., 3)`` [m].
        blow: ``(..., 3)`` [N s].
    """
    centre, mass, inertia = body
    turned = cross(at - centre, blow) / inertia[..., None]
    return velocity + blow / mass + cross(turned, place - centre), spin + turned
