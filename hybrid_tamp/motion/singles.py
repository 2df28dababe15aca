"""Products of one quaternion or vector, with plain numbers.

A call of numpy on three numbers takes longer than all multiplications of a rotation with plain numbers. These functions
compute the same bits as those for small batches (`component_products`), because all sums have the same order.
"""

from collections.abc import Sequence
from math import isfinite, sqrt

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray

FEW = 8
"""Largest number of vectors for which `rotate` is faster than the functions for batches."""
SHORT = 4
"""Largest number of elements for which `normalized` adds the squares in the same order as numpy."""

TINY = 1e-9
"""Sine of half an angle below which the angle is treated as twice the sine."""

Numbers = Sequence[float]
"""Components of a vector or of a quaternion."""


def are_few(vectors: FloatArray) -> bool:
    """Return whether `rotate` can rotate the vectors ``(..., 3)``, and is faster than the functions for batches."""
    return vectors.size == 3 or (vectors.ndim > 1 and vectors.shape[-2] > 1 and 0 < vectors.size <= 3 * FEW)


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cross product of two vectors. Each has 3 elements and any number of dimensions of length 1."""
    (ax, ay, az), (bx, by, bz) = a.ravel().tolist(), b.ravel().tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], ndmin=max(a.ndim, b.ndim))


def multiply(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return Hamilton's product of two quaternions. Each has 4 elements and any number of dimensions of length 1."""
    return np.array(_multiply(a.ravel().tolist(), b.ravel().tolist()), ndmin=max(a.ndim, b.ndim))


def rotate(q: FloatArray, v: FloatArray) -> FloatArray:
    """Rotate one vector of 3 elements, or a few vectors ``(..., n, 3)`` with n > 1, by a unit quaternion of 4 elements.

    The other dimensions of the quaternion have the length 1.
    """
    x, y, z, w = q.ravel().tolist()
    xx, yy, zz, xy, xz, yz, xw, yw, zw = x * x, y * y, z * z, x * y, x * z, y * z, x * w, y * w, z * w
    # The rotation matrix minus the identity.
    a, b, c = -2.0 * (yy + zz), 2.0 * (xy - zw), 2.0 * (xz + yw)
    d, e, f = 2.0 * (xy + zw), -2.0 * (xx + zz), 2.0 * (yz - xw)
    g, h, i = 2.0 * (xz - yw), 2.0 * (yz + xw), -2.0 * (xx + yy)
    numbers = v.ravel().tolist()
    # Each sum begins with 0, which turns a negative zero into a positive zero.
    if len(numbers) == 3:
        s, t, u = numbers
        first, second = s + (0.0 + a * s + b * t + c * u), t + (0.0 + d * s + (e * t + f * u))
        return np.array([first, second, u + (0.0 + g * s + h * t + i * u)], ndmin=max(q.ndim, v.ndim))
    rotated: list[float] = []
    for s, t, u in zip(numbers[::3], numbers[1::3], numbers[2::3], strict=True):
        rotated += (
            s + (0.0 + a * s + b * t + c * u),
            t + (0.0 + d * s + e * t + f * u),
            u + (0.0 + g * s + h * t + i * u),
        )
    return np.array(rotated).reshape((1,) * (q.ndim - v.ndim) + v.shape)


def exponential(vector: FloatArray) -> FloatArray:
    """Return the unit quaternion of a rotation vector of 3 elements [rad]."""
    return np.array(_exponential(vector.ravel().tolist()), ndmin=vector.ndim)


def logarithm(q: FloatArray) -> FloatArray:
    """Return the rotation vector [rad] of a unit quaternion of 4 elements, as `poses.rotation_vector` does."""
    x, y, z, w = q.ravel().tolist()
    if w < 0.0:
        x, y, z, w = -x, -y, -z, -w
    sine = sqrt(x * x + y * y + z * z)
    factor = 2.0 if sine < TINY else 2.0 * float(np.arctan2(sine, w)) / sine
    return np.array([factor * x, factor * y, factor * z], ndmin=q.ndim)


def integrate(q: FloatArray, angular_velocity: FloatArray, dt: float) -> FloatArray:
    """Return the orientation after a time step [s] with a constant angular velocity of 3 elements [rad/s].

    Raises:
        ValueError: the quaternion is zero or not finite.
    """
    turn = [each * dt for each in angular_velocity.ravel().tolist()]
    x, y, z, w = _multiply(_exponential(turn), q.ravel().tolist())
    square = (x * x + z * z) + (y * y + w * w)
    if not square > 0.0:
        raise ValueError("cannot normalise a quaternion that is zero or not finite")
    length = sqrt(square)
    return np.array([x / length, y / length, z / length, w / length], ndmin=max(q.ndim, angular_velocity.ndim))


def turn(axis: FloatArray, angle: FloatArray) -> FloatArray:
    """Return the rotation about a unit axis of 3 elements by one angle [rad], with dimensions of length 1 only."""
    half = 0.5 * angle.item()
    sine, cosine = float(np.sin(half)), float(np.cos(half))
    x, y, z = axis.ravel().tolist()
    return np.array([sine * x, sine * y, sine * z, cosine], ndmin=max(axis.ndim, angle.ndim + 1))


def normalized(vector: FloatArray) -> FloatArray:
    """Return a vector of any number of elements and of dimensions of length 1, scaled to unit length.

    Raises:
        ValueError: the vector is zero or not finite.
    """
    numbers = vector.ravel().tolist()
    largest = max(map(abs, numbers))
    if not (largest > 0.0 and all(map(isfinite, numbers))):
        raise ValueError("cannot normalise a vector that is zero or not finite")
    scaled = [number / largest for number in numbers]
    length = sqrt(sum([number * number for number in scaled]))
    return np.array([number / length for number in scaled], ndmin=vector.ndim)


def _multiply(a: Numbers, b: Numbers) -> list[float]:
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return [
        0.0 + ax * bw + ay * bz - az * by + aw * bx,
        0.0 - ax * bz + ay * bw + az * bx + aw * by,
        0.0 + ax * by - ay * bx + az * bw + aw * bz,
        0.0 - ax * bx - ay * by - az * bz + aw * bw,
    ]


def _exponential(vector: Numbers) -> list[float]:
    x, y, z = vector
    x, y, z = 0.5 * x, 0.5 * y, 0.5 * z
    # For a zero vector, the constant prevents 0 / 0. For other vectors, the constant is lost in rounding.
    half = sqrt(((x * x + z * z) + y * y) + 1e-60)
    share = float(np.sin(half)) / half
    return [share * x, share * y, share * z, float(np.cos(half))]
