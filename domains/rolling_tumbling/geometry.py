"""Where a roll goes: all vectors in the world frame, batch dimensions first."""

import numpy as np

from hybrid_tamp.authoring import Cylinder, FloatArray, State, Token, rotate

UP = np.array([0.0, 0.0, 1.0])
STANDOFF = 0.03
"""Gap between hand and object where a hand stands by [m]."""
FLOOR_CLEARANCE = 0.01
"""Gap that a hand keeps to the floor [m]."""


def dot(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the inner product over the last axis, ``(...)``."""
    return np.asarray(np.sum(one * other, axis=-1))


def axis(state: State, thing: Token) -> FloatArray:
    """Return the axis of rotation ``(..., 3)``."""
    return rotate(state[thing, "orientation"], np.asarray(thing["axis_of_rotation"]))


def heading(state: State, thing: Token) -> FloatArray:
    """Return the horizontal unit vector ``(..., 3)`` along which the thing rolls, up to its sign."""
    across = np.cross(axis(state, thing), UP)
    length = np.linalg.norm(across, axis=-1, keepdims=True)
    # An axis that stands upright has no heading; the margins of LIES_ON_SIDE say so, this only stays finite.
    return np.where(length > 1e-9, across / np.maximum(length, 1e-9), np.array([1.0, 0.0, 0.0]))


def way(state: State, thing: Token, region: Token) -> tuple[FloatArray, FloatArray]:
    """Return the direction ``(..., 3)`` of the roll to a region and the distance ``(...)`` [m] along it."""
    along = heading(state, thing)
    distance = dot(state[region, "position"] - state[thing, "position"], along)
    forward = np.where(distance < 0, -1.0, 1.0)
    return along * forward[..., None], np.abs(distance)


def reach_of(hand: Token, state: State, direction: FloatArray) -> FloatArray:
    """Return how far the hand's surface lies from its centre along a direction, ``(...)`` [m]."""
    shape = hand.shape
    assert isinstance(shape, Cylinder), "a STATIC END-EFFECTOR is a cylinder"
    along = np.abs(dot(rotate(state[hand, "orientation"], UP), direction))
    return shape.radius * np.sqrt(np.maximum(0.0, 1.0 - along**2)) + shape.length / 2 * along


def touching(state: State, hand: Token, thing: Token, direction: FloatArray) -> FloatArray:
    """Return the distance ``(...)`` [m] between the centres of a hand and a thing that it pushes."""
    return np.asarray(thing["radius_of_rotation"] + reach_of(hand, state, direction))


def working_height(state: State, hand: Token, thing: Token) -> FloatArray:
    """Return the height ``(...)`` [m] of a hand that pushes: that of the axis, but with the hand off the floor."""
    half = reach_of(hand, state, np.broadcast_to(UP, state[hand, "position"].shape))
    return np.maximum(state[thing, "position"][..., 2], half + FLOOR_CLEARANCE)


def standby(state: State, hand: Token, thing: Token, region: Token) -> FloatArray:
    """Return where a hand stands by ``(..., 3)`` [m] to push the thing to the region: behind it, low."""
    direction, _ = way(state, thing, region)
    behind = touching(state, hand, thing, direction) + STANDOFF
    place = state[thing, "position"] - direction * behind[..., None]
    return np.concatenate([place[..., :2], working_height(state, hand, thing)[..., None]], axis=-1)
