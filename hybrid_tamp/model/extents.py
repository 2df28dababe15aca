"""Extents of bodies along directions, in the world frame."""

from functools import lru_cache

import numpy as np

from hybrid_tamp.geometry.shapes import Box, Cylinder, Shape, Sphere
from hybrid_tamp.geometry.surfaces import points_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, rotate

_AXIS = np.array([0.0, 0.0, 1.0])
"""Axis of a cylinder in its body frame."""


def extent(state: State, token: Token, direction: FloatArray) -> FloatArray:
    """Return how far ``(...)`` [m] a body extends from the origin of its body frame in a direction ``(..., 3)``."""
    shape, orientation = token.solid, state[token, "orientation"]
    if isinstance(shape, Cylinder):
        along = np.abs(np.vecdot(rotate(orientation, _AXIS), direction))
        return np.asarray(shape.radius * np.sqrt(np.maximum(0.0, 1.0 - along**2)) + shape.length / 2 * along)
    local = rotate(quaternion_conjugate(orientation), direction)
    if isinstance(shape, Sphere):
        return np.full(local.shape[:-1], shape.radius)
    if isinstance(shape, Box):
        return np.asarray(np.ascontiguousarray(np.abs(local)) @ np.asarray(shape.half_extents))
    return np.asarray((local @ corners_of(shape).T).max(axis=-1))


@lru_cache(maxsize=256)
def corners_of(shape: Shape) -> FloatArray:
    """Return the corners ``(k, 3)`` [m] of a shape in the body frame."""
    return points_of(shape)
