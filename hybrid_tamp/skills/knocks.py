"""Impulses on a rigid body, such as a hand with the object that it holds."""

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import cross
from hybrid_tamp.skills.vectors import dot

Mass = tuple[FloatArray, float, FloatArray]
"""Centre of mass ``(..., 3)`` [m], mass [kg] and moment of inertia ``(...)`` [kg m^2] of a body."""
Changes = dict[tuple[str, str], FloatArray]
"""Maps (token, varying property) to new values."""


def effective_mass(body: Mass, at: FloatArray, direction: FloatArray) -> FloatArray:
    """Return the effective mass ``(...)`` [kg] of a body in an impact at a point along a unit direction.

    An impulse P at distance l from the common centre of mass changes the speed of the point by P (1/M + l^2/I).
    """
    centre, mass, inertia = body
    lever = cross(at - centre, direction)
    return np.asarray(1.0 / (1.0 / mass + dot(lever, lever) / inertia))


def knocked(
    body: Mass, velocity: FloatArray, spin: FloatArray, place: FloatArray, at: FloatArray, impulse: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the velocity ``(..., 3)`` of a place of the body and the angular velocity ``(..., 3)`` after an impact.

    Args:
        body: mass of the body, e.g. of a hand with the object that it holds.
        velocity: velocity of the place before the impact ``(..., 3)`` [m/s].
        spin: angular velocity of the body before the impact ``(..., 3)`` [rad/s].
        place: position of the place, e.g. of the hand ``(..., 3)`` [m].
        at: point of impact ``(..., 3)`` [m].
        impulse: impulse on the body ``(..., 3)`` [N s].
    """
    centre, mass, inertia = body
    turned = cross(at - centre, impulse) / inertia[..., None]
    return velocity + impulse / mass + cross(turned, place - centre), spin + turned
