"""Body axes of a box about which hands turn the box, and the orientation of a hand at a face.

A hand lies along the edge about which the box turns. This edge is parallel to a body axis of the box. The axis of a
hand that cannot turn determines this body axis. A hand that can turn lies along the level body axis beside its face, so
the pose of the box alone determines the orientation that the hand wants.
"""

import numpy as np

from hybrid_tamp.authoring import FloatArray, State, Token, cross, normalized, quaternion_multiply, rotate
from hybrid_tamp.skills import NORMALS, can_turn, dot, norm, to_body, z_axis

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


def wanted_axis(state: State, hand: Token, thing: Token, face: str) -> FloatArray:
    """Return the direction ``(..., 3)`` along which a hand that can turn lies at a face.

    Of the two opposite directions, the result is the direction nearer to the hand's present axis.
    """
    along = parallelism(state, hand, thing) - 2.0 * np.abs(NORMALS[face])
    wanted = rotate(state[thing, "orientation"], _AXES[np.argmax(along, axis=-1)])
    return np.asarray(wanted * np.where(dot(wanted, z_axis(state, hand)) < 0.0, -1.0, 1.0)[..., None])


def wanted_orientation(state: State, hand: Token, thing: Token, face: str) -> FloatArray:
    """Return the orientation ``(..., 4)`` of a hand at a face. A hand that cannot turn keeps its orientation.

    The hand turns by the smallest angle that makes its axis parallel to `wanted_axis`, so it does not turn about its
    own axis. The angle is at most 90 degrees.
    """
    if not can_turn(hand):
        return state[hand, "orientation"]
    present, wanted = z_axis(state, hand), wanted_axis(state, hand, thing, face)
    # The half-way quaternion of the two unit vectors. Its scalar part is at least 1, so it never vanishes.
    turn = normalized(np.concatenate([cross(present, wanted), 1.0 + dot(present, wanted)[..., None]], axis=-1))
    return quaternion_multiply(turn, state[hand, "orientation"])


def off_axis(state: State, hand: Token, thing: Token, face: str) -> FloatArray:
    """Return the angle ``(...)`` [rad] between a hand that can turn and its `wanted_axis` at a face."""
    present, wanted = z_axis(state, hand), wanted_axis(state, hand, thing, face)
    return np.arctan2(norm(cross(present, wanted)), dot(present, wanted))
