"""Geometry of objects with a handle (`Graspable`): places on the handle, and the attitude of the object.

An object is turned about the vertical by its yaw, and then leans in the vertical plane of its heading. This plane
contains the x axis of the body frame, which points along the handle, and the z axis. The lean is 0 if the object stands
with x down and z ahead, -pi/2 if it is level with x ahead, and -pi if x is up. Vectors are in the world frame unless a
name says otherwise. Batch dimensions come first.
"""

import numpy as np

from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rpy, rotate
from hybrid_tamp.skills.extents import reach_along
from hybrid_tamp.skills.vectors import dot, in_body, norm, point, unit

_BESIDE = 0.09
"""Distance between a handle and a hand that waits before or after a grasp [m]."""
_ON_OTHER_SIDE = _BESIDE / 2.0
"""Least distance from the handle at which a hand waits on the side towards -y [m].

A hand that holds the handle is nearer, so the error of a servo never decides on which side the hand leaves the handle.
"""
_X, _Y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
_RIGHT, _AHEAD_OF_SIDE = np.array([1, 0, 2]), np.array([1.0, -1.0, 0.0])
"""Indices and signs of the components in the cross product of a vector and `UP`."""


_CLEARANCE = 0.005
"""Smallest gap between a hand on a handle and the surface on which the object stands [m]."""


def hand_in(state: State, hand: Token, thing: Token) -> FloatArray:
    """Return the position ``(..., 3)`` [m] of a hand's centre in the body frame of an object."""
    return in_body(state, thing, state[hand, "position"])


def handle_length(thing: Token) -> float:
    """Return the length of the graspable segment [m]."""
    return float(thing["handle_to"][0] - thing["handle_from"][0])


def on_handle(thing: Token, location: FloatArray | float) -> FloatArray:
    """Return the point ``(..., 3)`` [m] of the handle, in the body frame, at a distance [m] from ``handle_to``."""
    return np.asarray(thing["handle_to"] - np.asarray(location)[..., None] * _X)


def location_on_handle(state: State, hand: Token, thing: Token) -> FloatArray:
    """Return the distance ``(...)`` [m] along the handle from ``handle_to`` to the hand."""
    return np.asarray(thing["handle_to"][0] - hand_in(state, hand, thing)[..., 0])


def off_handle(state: State, hand: Token, thing: Token) -> FloatArray:
    """Return the distance ``(...)`` [m] between a hand's centre and the graspable segment."""
    place = hand_in(state, hand, thing)
    along = np.clip(place[..., 0], thing["handle_from"][0], thing["handle_to"][0])
    return norm(
        place - np.concatenate([along[..., None], np.broadcast_to(thing["handle_to"][1:], (*along.shape, 2))], -1)
    )


def beside_handle(state: State, hand: Token, thing: Token) -> FloatArray:
    """Return the waiting position ``(..., 3)`` [m] of a hand beside the middle of a handle, on the hand's side.

    For a hand near the handle, this is the side towards the y axis of the object.
    """
    aside = np.where(hand_in(state, hand, thing)[..., 1] < -_ON_OTHER_SIDE, -_BESIDE, _BESIDE)
    middle = on_handle(thing, handle_length(thing) / 2)
    return point(state, thing, middle + aside[..., None] * _Y)


def side(state: State, thing: Token) -> FloatArray:
    """Return the y axis ``(..., 3)`` of an object, which is the axis about which it leans."""
    return rotate(state[thing, "orientation"], _Y)


def heading(state: State, thing: Token) -> FloatArray:
    """Return the horizontal unit vector ``(..., 3)`` that points ahead of an object."""
    return unit(side(state, thing).take(_RIGHT, -1) * _AHEAD_OF_SIDE)


def yaw(state: State, thing: Token) -> FloatArray:
    """Return the angle ``(...)`` [rad] of an object's heading about the vertical axis."""
    ahead = heading(state, thing)
    return np.arctan2(ahead[..., 1], ahead[..., 0])


def lean(state: State, thing: Token) -> FloatArray:
    """Return the lean ``(...)`` [rad] of an object, from -3/2 pi to pi/2. The lean is 0 if the object stands."""
    along = rotate(state[thing, "orientation"], _X)
    angle = np.arctan2(-dot(along, heading(state, thing)), -along[..., 2])
    return np.asarray(np.where(angle > np.pi / 2, angle - 2 * np.pi, angle))


def attitude(direction: FloatArray | float, angle: FloatArray | float) -> FloatArray:
    """Return the orientation ``(..., 4)`` of an object with a yaw ``(...)`` [rad] and a lean ``(...)`` [rad]."""
    turned, leaning = np.broadcast_arrays(direction, np.asarray(angle) + np.pi / 2)
    return quaternion_from_rpy(np.stack([np.zeros_like(turned), leaning, turned], axis=-1))


def standing_height(thing: Token) -> float:
    """Return the height [m] of the centre of mass of an object that stands, above the surface below."""
    return reach_along(thing, _X)


def least_extent(hand: Token) -> float:
    """Return the smallest extent [m] of a cylindrical hand below its centre, over all its orientations."""
    return float(min(hand["radius"], hand["length"] / 2))


def lowest_grasp(thing: Token, below: FloatArray | float) -> FloatArray:
    """Return the distance ``(...)`` [m] from ``handle_to`` beyond which a hand is clear of what the object stands on.

    Args:
        thing: the object.
        below: extent ``(...)`` [m] of the hand below its centre.
    """
    return np.asarray(below + _CLEARANCE - standing_height(thing) + thing["handle_to"][0])
