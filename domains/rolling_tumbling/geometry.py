"""Directions and places of a roll: all vectors in the world frame, batch dimensions first."""

import numpy as np

from hybrid_tamp.authoring import Cylinder, FloatArray, State, Token, rotate

from ..common.vectors import UP, dot

STANDOFF = 0.03
"""Gap between an object and a hand that stands by [m]."""
FLOOR_CLEARANCE = 0.01
"""Least gap between a hand and the floor [m]."""


def axis(state: State, thing: Token) -> FloatArray:
    """Return the axis of rotation ``(..., 3)``."""
    return rotate(state[thing, "orientation"], np.asarray(thing["axis_of_rotation"]))


def heading(state: State, thing: Token) -> FloatArray:
    """Return the horizontal unit vector ``(..., 3)`` along which the thing rolls, up to its sign."""
    across = np.cross(axis(state, thing), UP)
    length = np.linalg.norm(across, axis=-1, keepdims=True)
    # A vertical axis has no heading: the result must stay finite, and LIES_ON_SIDE does not hold.
    return np.where(length > 1e-9, across / np.maximum(length, 1e-9), np.array([1.0, 0.0, 0.0]))


def way(state: State, thing: Token, region: Token) -> tuple[FloatArray, FloatArray]:
    """Return the direction ``(..., 3)`` of the roll to a region and the distance ``(...)`` [m] along it."""
    along = heading(state, thing)
    distance = dot(state[region, "position"] - state[thing, "position"], along)
    forward = np.where(distance < 0, -1.0, 1.0)
    return along * forward[..., None], np.abs(distance)


def reach_of(hand: Token, state: State, direction: FloatArray) -> FloatArray:
    """Return the distance ``(...)`` [m] from the hand's centre to its surface along a direction."""
    shape = hand.shape
    assert isinstance(shape, Cylinder), "a STATIC END-EFFECTOR is a cylinder"
    along = np.abs(dot(rotate(state[hand, "orientation"], UP), direction))
    return shape.radius * np.sqrt(np.maximum(0.0, 1.0 - along**2)) + shape.length / 2 * along


def touching(state: State, hand: Token, thing: Token, direction: FloatArray) -> FloatArray:
    """Return the distance ``(...)`` [m] between the centres of a hand and a thing that it pushes."""
    return np.asarray(thing["radius_of_rotation"] + reach_of(hand, state, direction))


def working_height(state: State, hand: Token, thing: Token) -> FloatArray:
    """Return the height ``(...)`` [m] of a hand that pushes: the height of the axis, but clear of the floor."""
    half = reach_of(hand, state, np.broadcast_to(UP, state[hand, "position"].shape))
    return np.maximum(state[thing, "position"][..., 2], half + FLOOR_CLEARANCE)


def standby(state: State, hand: Token, thing: Token, region: Token) -> FloatArray:
    """Return the place ``(..., 3)`` [m], behind a thing, of a hand that stands by to push it to the region."""
    direction, _ = way(state, thing, region)
    behind = touching(state, hand, thing, direction) + STANDOFF
    place = state[thing, "position"] - direction * behind[..., None]
    return np.concatenate([place[..., :2], working_height(state, hand, thing)[..., None]], axis=-1)
