"""Products of vectors and quaternions for large batches, component by component.

For a small batch, the number of calls of numpy determines the time, and `component_products` needs few of them. For a
large batch, copying components determines the time, and these functions copy nothing.
"""

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray

LARGE = 300
"""Number of elements above which the functions of this module are faster."""


def is_large(one: FloatArray, other: FloatArray) -> bool:
    """Return whether one of two arrays is so large that the functions of this module are faster."""
    return one.size > LARGE or other.size > LARGE


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cross products of vectors ``(..., 3)``."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    (ax, ay, az), (bx, by, bz) = _split(a), _split(b)
    out[..., 0] = ay * bz - az * by
    out[..., 1] = az * bx - ax * bz
    out[..., 2] = ax * by - ay * bx
    return out


def multiply(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return Hamilton's products of quaternions ``(..., 4)``."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    (ax, ay, az, aw), (bx, by, bz, bw) = _split(a), _split(b)
    out[..., 0] = aw * bx + ax * bw + ay * bz - az * by
    out[..., 1] = aw * by + ay * bw + az * bx - ax * bz
    out[..., 2] = aw * bz + az * bw + ax * by - ay * bx
    out[..., 3] = aw * bw - ax * bx - ay * by - az * bz
    return out


def rotate(q: FloatArray, v: FloatArray) -> FloatArray:
    """Rotate vectors ``(..., 3)`` by unit quaternions ``(..., 4)``: ``v + w t + u x t`` with ``t = 2 u x v``."""
    out = np.empty((*np.broadcast_shapes(q.shape[:-1], v.shape[:-1]), 3))
    (x, y, z, w), (a, b, c) = _split(q), _split(v)
    first, second, third = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    out[..., 0] = a + w * first + (y * third - z * second)
    out[..., 1] = b + w * second + (z * first - x * third)
    out[..., 2] = c + w * third + (x * second - y * first)
    return out


def _split(array: FloatArray) -> tuple[FloatArray, ...]:
    """Return the components of an array ``(..., d)``, each ``(...)``."""
    return tuple(array[..., index] for index in range(array.shape[-1]))
