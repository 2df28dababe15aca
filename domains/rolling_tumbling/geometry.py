"""Directions and positions of a roll. All vectors are in the world frame, with batch dimensions first."""

import numpy as np

from hybrid_tamp.authoring import Cylinder, FloatArray, State, Token, cross, rotate
from hybrid_tamp.skills import UP, dot, norm, unit

FLOOR_CLEARANCE = 0.01
"""Smallest gap between a hand and the floor [m]."""

_POINTS = 5
"""Number of points along the axis of a hand at which `gap_between` measures."""


def axis(state: State, thing: Token) -> FloatArray:
    """Return an object's axis of rotation ``(..., 3)``, a unit vector."""
    return rotate(state[thing, "orientation"], np.asarray(thing["axis_of_rotation"]))


def heading(state: State, thing: Token) -> FloatArray:
    """Return the horizontal unit vector ``(..., 3)`` along which an object rolls, with an arbitrary sign."""
    # If the axis is vertical, LIES_ON_SIDE does not hold.
    return unit(cross(axis(state, thing), UP))


def way(state: State, thing: Token, region: Token) -> tuple[FloatArray, FloatArray]:
    """Return the direction ``(..., 3)`` of a roll to a region, and the distance ``(...)`` [m] in this direction."""
    along = heading(state, thing)
    distance = dot(state[region, "position"] - state[thing, "position"], along)
    forward = np.where(distance < 0, -1.0, 1.0)
    return along * forward[..., None], np.abs(distance)


def gap_between(state: State, hand: Token, thing: Token) -> FloatArray:
    """Return the gap ``(...)`` [m] between an object and the largest capsule in a hand, negative if they overlap."""
    shape = hand.shape
    assert isinstance(shape, Cylinder), "the shape of a STATIC END-EFFECTOR must be a cylinder"
    reach = max(shape.length / 2 - shape.radius, 0.0)
    ends = np.linspace(-reach, reach, _POINTS)[:, None] * UP
    along = axis(state, thing)[..., None, :]
    points = (
        rotate(state[hand, "orientation"][..., None, :], ends)
        + (state[hand, "position"] - state[thing, "position"])[..., None, :]
    )
    if isinstance(thing.shape, Cylinder):
        aside = dot(points, along)
        across = norm(points - aside[..., None] * along) - thing["radius_of_rotation"]
        beyond = np.abs(aside) - thing.shape.length / 2
        outside = np.hypot(np.maximum(across, 0.0), np.maximum(beyond, 0.0))
        distance = np.where((across > 0) | (beyond > 0), outside, np.maximum(across, beyond))
    else:
        distance = norm(points) - thing["radius_of_rotation"]
    return np.asarray(distance.min(axis=-1) - shape.radius)
