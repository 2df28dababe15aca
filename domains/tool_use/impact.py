"""Impacts of a tool on an object: the impulse that the object receives, and the velocities after the impact."""

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.authoring import CONTROL_PERIOD, FloatArray, State, Token, cross, grip_limits
from hybrid_tamp.skills import Changes, Mass, dot, effective_mass


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
