"""Body axes of a box about which hands turn the box, and the orientation of a hand at a face.

A hand lies along the edge about which the box turns. This edge is parallel to a body axis of the box. The axis of a
hand that cannot turn determines this body axis. A hand that can turn lies along the level body axis beside its face, so
the pose of the box alone determines the orientation that the hand wants.
"""

import numpy as np

from hybrid_tamp.authoring import FloatArray, State, Token, rotate
from hybrid_tamp.skills import NORMALS, Alignment, can_turn, to_body, z_axis

_AXES = np.eye(3)
_LEVEL = 0.5
"""Largest vertical component of a body axis that counts as level."""


def parallelism(state: State, hand: Token, thing: Token) -> FloatArray:
    """Return how parallel ``(..., 3)``, from 0 to 1, each body axis of a box is to the hand at any of its places."""
    if can_turn(hand):
        return np.asarray(1.0 - np.abs(rotate(state[thing, "orientation"][..., None, :], _AXES)[..., 2]))
    return np.abs(to_body(state, thing, z_axis(state, hand)))


def own_axis(state: State, hand: Token, thing: Token) -> int:
    """Return the index of the body axis of a box that is nearest to the hand's present axis, for a single state."""
    return int(np.argmax(np.abs(to_body(state, thing, z_axis(state, hand)))))


def axis_beside(state: State, hand: Token, thing: Token, face: str) -> int:
    """Return the index of the body axis along which a hand lies at a face, for a single state."""
    return int(np.argmax(parallelism(state, hand, thing) - 2.0 * np.abs(NORMALS[face])))


def axes_of_turn(state: State, hand: Token, thing: Token) -> tuple[int, ...]:
    """Return the indices of the body axes about which a hand can turn a box, for a single state."""
    if not can_turn(hand):
        return (own_axis(state, hand, thing),)
    along = parallelism(state, hand, thing)
    level = tuple(index for index in range(3) if along[index] >= 1.0 - _LEVEL)
    return level or (int(np.argmax(along)),)


def _line_beside(state: State, hand: Token, thing: Token, face: str) -> FloatArray:
    """Return the direction ``(..., 3)`` of the line along which a hand that can turn lies at a face."""
    along = parallelism(state, hand, thing) - 2.0 * np.abs(NORMALS[face])
    return rotate(state[thing, "orientation"], _AXES[np.argmax(along, axis=-1)])


ALIGNMENT = Alignment(_line_beside, float(np.radians(6.0)))
"""How a hand lies at a face of a box: level, and parallel to the face."""
