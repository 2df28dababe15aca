"""Vector operations that several domains use. Batch dimensions come first."""

import numpy as np

from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import cross, quaternion_conjugate, rotate

UP = np.array([0.0, 0.0, 1.0])
"""Unit vector ``(3,)`` that points up."""
HORIZONTAL = np.array([1.0, 1.0, 0.0])
"""Factor that removes the vertical component of a vector."""


def dot(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the inner product ``(...)`` over the last axis."""
    return np.asarray(np.vecdot(one, other))


def to_body(state: State, token: Token, vectors: FloatArray) -> FloatArray:
    """Express vectors ``(..., 3)`` of the world frame in a token's body frame."""
    return rotate(quaternion_conjugate(state[token, "orientation"]), vectors)


def z_axis(state: State, token: Token) -> FloatArray:
    """Return the z axis ``(..., 3)`` of a token's body frame, e.g. the axis of a cylindrical hand."""
    return rotate(state[token, "orientation"], UP)


def depth_in_workspace(hand: Token, position: FloatArray) -> FloatArray:
    """Return the depth ``(...)`` [m] of positions ``(..., 3)`` in a hand's workspace. It is negative outside."""
    lower, upper = np.asarray(hand["workspace_lower"]), np.asarray(hand["workspace_upper"])
    return np.asarray(np.minimum.reduce(np.minimum(position - lower, upper - position), axis=-1))


def largest_depth(hand: Token, position: FloatArray, radius: float) -> FloatArray:
    """Return an upper bound ``(...)`` [m] of `depth_in_workspace` for positions ``(..., 3)`` [m].

    The bound covers horizontal displacements by at most `radius` [m].
    """
    lower, upper = np.asarray(hand["workspace_lower"]), np.asarray(hand["workspace_upper"])
    depth = np.minimum(position - lower, upper - position) + np.array([radius, radius, 0.0])
    return np.asarray(np.minimum(depth, (upper - lower) / 2.0).min(axis=-1))


def norm(vector: FloatArray) -> FloatArray:
    """Return the Euclidean norm ``(...)`` over the last axis."""
    return np.sqrt(dot(vector, vector))


def unit(vector: FloatArray) -> FloatArray:
    """Return vectors ``(..., 3)`` of length 1 with the same directions. The result for a zero vector is the x axis."""
    length = norm(vector)[..., None]
    # The result must be finite for a zero vector, too. Predicates exclude states with a zero vector.
    if np.minimum.reduce(length, axis=None, initial=1.0) > 1e-9:
        return np.asarray(vector / length)
    return np.where(length > 1e-9, vector / np.maximum(length, 1e-9), np.array([1.0, 0.0, 0.0]))


def point(state: State, token: Token, body: FloatArray) -> FloatArray:
    """Convert a point ``(..., 3)`` [m] from the token's body frame to the world frame."""
    return state[token, "position"] + rotate(state[token, "orientation"], body)


def in_body(state: State, token: Token, place: FloatArray) -> FloatArray:
    """Convert a position ``(..., 3)`` [m] from the world frame to the token's body frame."""
    return to_body(state, token, place - state[token, "position"])


def point_velocity(state: State, token: Token, body: FloatArray) -> FloatArray:
    """Return the velocity ``(..., 3)`` [m/s] of a point of the token. The point `body` is in the body frame."""
    arm = rotate(state[token, "orientation"], body)
    return np.asarray(state[token, "velocity"] + cross(state[token, "angular_velocity"], arm))


def stop_at_face(velocity: FloatArray, outward: FloatArray, gap: FloatArray, dt: float) -> FloatArray:
    """Return the velocity ``(..., 3)`` [m/s] of a body, limited so that it does not pass a face within a time step [s].

    Args:
        velocity: velocity ``(..., 3)`` [m/s] without the face.
        outward: outward normal ``(..., 3)`` of the face.
        gap: distance ``(...)`` [m] between the body and the face. A negative gap counts as 0.
        dt: time step [s].
    """
    inward = -dot(velocity, outward) - np.maximum(gap, 0.0) / dt
    return np.asarray(velocity + outward * np.maximum(inward, 0.0)[..., None])
