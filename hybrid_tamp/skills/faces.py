"""Faces of boxes. A face is named by the direction of its normal in the body frame of the box, e.g. "left" is -x."""

from functools import cache

import numpy as np

from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate
from hybrid_tamp.skills.vectors import dot, in_body

NORMALS: dict[str, FloatArray] = {
    "left": np.array([-1.0, 0.0, 0.0]),
    "right": np.array([1.0, 0.0, 0.0]),
    "front": np.array([0.0, -1.0, 0.0]),
    "back": np.array([0.0, 1.0, 0.0]),
    "bottom": np.array([0.0, 0.0, -1.0]),
    "top": np.array([0.0, 0.0, 1.0]),
}
"""Maps each face to its outward normal ``(3,)`` in the body frame."""

_OPPOSITE = {"left": "right", "front": "back", "bottom": "top"}
OPPOSITE = _OPPOSITE | {other: one for one, other in _OPPOSITE.items()}
"""Maps each face to the opposite face."""

STANDBY_GAP = 0.012
"""Gap between a face and a hand in its standby position [m]."""


def half_extent(thing: Token, face: str) -> float:
    """Return the distance [m] of a face from the centre of a box, which has the property `half_extents`."""
    return float(np.abs(NORMALS[face]) @ np.asarray(thing["half_extents"]))


def contact_distance(thing: Token, face: str) -> float:
    """Return the distance [m] of the plane that a hand touches at a face from the centre of the box.

    If the box has the property `hollow`, the hand touches the bottom of the hollow in the face.
    """
    depths = np.asarray(thing.properties.get("hollow", (0.0, 0.0, 0.0)))
    return float(np.abs(NORMALS[face]) @ (np.asarray(thing["half_extents"]) - depths))


def normals(state: State, thing: Token, *faces: str) -> FloatArray:
    """Return the outward unit normals ``(..., n, 3)`` of n faces in the world frame."""
    return rotate(state[thing, "orientation"][..., None, :], _table(faces))


@cache
def _table(faces: tuple[str, ...]) -> FloatArray:
    return np.array([NORMALS[face] for face in faces])


def normal(state: State, thing: Token, face: str) -> FloatArray:
    """Return the outward unit normal ``(..., 3)`` of a face in the world frame."""
    return rotate(state[thing, "orientation"], NORMALS[face])


def gap_to_face(state: State, hand: Token, thing: Token, face: str) -> FloatArray:
    """Return the distance ``(...)`` [m] between a hand with a radius and the plane that the hand touches at a face."""
    offset = in_body(state, thing, state[hand, "position"])
    return np.asarray(dot(offset, NORMALS[face]) - contact_distance(thing, face) - hand["radius"])
