"""Products of vectors and quaternions for large batches, component by component.

For a small batch, the number of calls of numpy determines the time, and `component_products` needs few of them. For a
large batch, the access to memory determines the time. These functions copy nothing, and store each component of their
results in one piece. Operations on such arrays are several times as fast as on arrays that store vector after vector.
"""

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray

LARGE = 300
"""Number of elements above which the functions of this module are faster."""


def is_large(one: FloatArray, other: FloatArray) -> bool:
    """Return whether one of two arrays is so large that the functions of this module are faster."""
    return one.size > LARGE or other.size > LARGE


def stored_by_column(array: FloatArray) -> FloatArray:
    """Return the same values ``(..., d)``. Each component of a large array is stored in one piece."""
    if array.ndim < 2 or array.size <= LARGE / 3 * array.shape[-1]:
        return array
    stored = np.empty((array.shape[-1], *array.shape[:-1]))
    stored[...] = _split(array)
    return _join(stored)


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cross products of vectors ``(..., 3)``."""
    out = np.empty((3, *_batch(a, b)))
    (ax, ay, az), (bx, by, bz) = _split(a), _split(b)
    np.subtract(ay * bz, az * by, out=out[0])
    np.subtract(az * bx, ax * bz, out=out[1])
    np.subtract(ax * by, ay * bx, out=out[2])
    return _join(out)


def multiply(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return Hamilton's products of quaternions ``(..., 4)``."""
    out = np.empty((4, *_batch(a, b)))
    x, y, z, w = out
    (ax, ay, az, aw), (bx, by, bz, bw) = _split(a), _split(b)
    np.multiply(aw, bx, out=x)
    x += ax * bw
    x += ay * bz
    x -= az * by
    np.multiply(aw, by, out=y)
    y += ay * bw
    y += az * bx
    y -= ax * bz
    np.multiply(aw, bz, out=z)
    z += az * bw
    z += ax * by
    z -= ay * bx
    np.multiply(aw, bw, out=w)
    w -= ax * bx
    w -= ay * by
    w -= az * bz
    return _join(out)


def rotate(q: FloatArray, v: FloatArray) -> FloatArray:
    """Rotate vectors ``(..., 3)`` by unit quaternions ``(..., 4)``: ``v + w t + u x t`` with ``t = 2 u x v``."""
    if q.ndim == v.ndim == 3 and len(q) == len(v) and q.shape[1] == 1 < v.shape[1]:
        # Each quaternion rotates several vectors. The long dimension comes last, so that numpy has few inner loops.
        moved: FloatArray = rotate(q.transpose(1, 0, 2), np.ascontiguousarray(v.T).T.transpose(1, 0, 2))
        return np.asarray(moved.transpose(1, 0, 2))
    out = np.empty((3, *_batch(q, v)))
    (x, y, z, w), (a, b, c) = _split(q), _split(v)
    first, second, third = y * c, z * a, x * b
    first -= z * b
    second -= x * c
    third -= y * a
    for each in (first, second, third):
        each *= 2.0
    for total, each, turned in zip(out, (a, b, c), (first, second, third), strict=True):
        np.multiply(w, turned, out=total)
        total += each
    for total, one, other in zip(
        out, (y * third, z * first, x * second), (z * second, x * third, y * first), strict=True
    ):
        one -= other
        total += one
    return _join(out)


def extended(vectors: FloatArray, last: FloatArray) -> FloatArray:
    """Return vectors ``(..., d)`` with a further component ``(...)`` at the end."""
    if not is_large(vectors, vectors):
        return np.concatenate([vectors, last[..., None]], axis=-1)
    out = np.empty((vectors.shape[-1] + 1, *vectors.shape[:-1]))
    out[:-1] = _split(vectors)
    out[-1] = last
    return _join(out)


def sum_squares(vectors: FloatArray) -> FloatArray:
    """Return the squared norms ``(...)`` of vectors with 3 or 4 components, with the same bits as `numpy.einsum`."""
    x, y, z, *rest = _split(vectors)
    return np.asarray(x * x + z * z + (y * y if not rest else y * y + rest[0] * rest[0]))


def _batch(one: FloatArray, other: FloatArray) -> tuple[int, ...]:
    """Return the broadcast shape of two arrays without the last dimension."""
    first, second = one.shape[:-1], other.shape[:-1]
    if first == second or not second:
        return first
    return np.broadcast_shapes(first, second)


def _split(array: FloatArray) -> FloatArray:
    """Return the components of an array ``(..., d)``, as an array ``(d, ...)``."""
    return np.asarray(array.T if array.ndim == 2 else array.transpose(array.ndim - 1, *range(array.ndim - 1)))


def _join(components: FloatArray) -> FloatArray:
    """Return an array ``(..., d)`` of components ``(d, ...)``."""
    return np.asarray(components.T if components.ndim == 2 else components.transpose(*range(1, components.ndim), 0))
