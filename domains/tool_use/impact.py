"""Impacts of a tool on an object: the impulse, and how it knocks the hand and the tool back."""

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.authoring import CONTROL_PERIOD, FloatArray, State, Token, cross, grip_limits
from hybrid_tamp.skills import dot

Mass = tuple[FloatArray, float, FloatArray]
"""Centre of mass ``(..., 3)`` [m], mass [kg] and moment of inertia ``(...)`` [kg m^2] of a body."""
Changes = dict[tuple[str, str], FloatArray]
"""Maps (token, varying property) to new values."""


def effective_mass(body: Mass, at: FloatArray, direction: FloatArray) -> FloatArray:
    """Return the effective mass ``(...)`` [kg] of a hand with its tool in an impact at a point along a unit direction.

    An impulse P at distance l from the common centre of mass changes the speed of the point by P (1/M + l^2/I).
    """
    centre, mass, inertia = body
    lever = cross(at - centre, direction)
    return np.asarray(1.0 / (1.0 / mass + dot(lever, lever) / inertia))


def knocked(
    body: Mass, velocity: FloatArray, spin: FloatArray, place: FloatArray, at: FloatArray, impulse: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the velocity of the hand and the angular velocity of the body after an impact on the tool.

    Args:
        body: the hand with its tool.
        velocity: velocity of the hand before the impact ``(..., 3)`` [m/s].
        spin: angular velocity of the body before the impact ``(..., 3)`` [rad/s].
        place: position of the hand ``(..., 3)`` [m].
        at: point of impact ``(..., 3)`` [m].
        impulse: impulse on the tool ``(..., 3)`` [N s].
    """
    centre, mass, inertia = body
    turned = cross(at - centre, impulse) / inertia[..., None]
    return velocity + impulse / mass + cross(turned, place - centre), spin + turned


def impulse_within_period(
    hand: Token, tool: Token, state: State, whole: Mass, at: FloatArray, speed: FloatArray, direction: FloatArray
) -> FloatArray:
    """Return the impulse ``(...)`` [N s] that an object receives within one control period of an inelastic impact.

    This is the window of the property `impulse`. The tool alone gives its momentum at once. Within the window, the hand
    adds at most what the grip passes on, by the force of one finger and the moment of the pads' pressure. In total, the
    impulse is at most that of the hand and the tool as one body.

    Args:
        hand: hand that holds the tool.
        tool: the tool.
        state: state at the impact.
        whole: mass of the hand with its tool.
        at: point of impact ``(..., 3)`` [m].
        speed: speed ``(...)`` [m/s] of this point against the object.
        direction: unit vector ``(..., 3)`` of the impulse on the tool.
    """
    centre, mass, inertia = state[tool, "position"], tool["mass"], tool["inertia"][1]
    lever = cross(at - centre, direction)
    held_by = cross(state[hand, "position"] - centre, direction)
    alone = 1.0 / (1.0 / mass + dot(lever, lever) / inertia)
    limits = grip_limits(hand, tool, hand["maximal_grip"])
    pressed = limits[2] * np.abs(1.0 / mass + dot(lever, held_by) / inertia)
    turned = limits[4] * np.sqrt(dot(lever, lever)) / inertia
    together = effective_mass(whole, at, direction) * speed
    return np.asarray(np.minimum(together, alone * (speed + (pressed + turned) * CONTROL_PERIOD)))


def bounced(
    changes: Changes, pair: tuple[Token, Token], where: NDArray[np.bool_], after: tuple[FloatArray, FloatArray]
) -> Changes:
    """Return the velocities of a hand and its tool after a contact, for the members ``(...)`` of the batch that touch.

    Args:
        changes: poses and velocities after the step.
        pair: the hand and the tool.
        where: which members touch.
        after: velocity [m/s] of the hand and angular velocity [rad/s] of the body after the contact, ``(..., 3)``.
    """
    hand, tool = pair
    velocity, spin = after
    arm = changes[tool.name, "position"] - changes[hand.name, "position"]
    found = {
        (hand.name, "velocity"): velocity,
        (tool.name, "velocity"): velocity + cross(spin, arm),
        (hand.name, "angular_velocity"): spin,
        (tool.name, "angular_velocity"): spin,
    }
    return {key: np.where(where[..., None], value, changes[key]) for key, value in found.items()}
