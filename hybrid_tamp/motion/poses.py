"""Batched rotations as unit quaternions ``(x, y, z, w)``.

The equations are from Sola 2017, "Quaternion kinematics for the error-state Kalman filter" (arXiv:1711.02508). In
contrast to Sola, the scalar part of a quaternion comes last.
"""

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.motion import columns, singles
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.component_products import EACH_ROW, HAMILTON, ROW_SUMS, TURN, products

_CONJUGATION = np.array([-1.0, -1.0, -1.0, 1.0])
_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])


def check_size(values: ArrayLike, size: int, name: str) -> FloatArray:
    """Return values as an array of numbers ``(..., size)``, or raise a `ValueError` if the last dimension differs."""
    array = np.asarray(values, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != size:
        raise ValueError(f"{name} must have shape (..., {size}), got {array.shape}")
    return array


def _sum_squares(vectors: FloatArray) -> FloatArray:
    """Return the squared norms ``(...)`` of vectors ``(..., 3)`` or quaternions ``(..., 4)``."""
    if columns.is_large(vectors, vectors):
        return columns.sum_squares(vectors)
    return np.asarray(np.einsum("...i,...i->...", vectors, vectors))


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cross products of vectors ``(..., 3)``, several times as fast as `numpy.cross`."""
    if a.size == 3 and b.size == 3:
        return singles.cross(a, b)
    if columns.is_large(a, b):
        return columns.cross(a, b)
    return np.asarray(a.take(_NEXT, -1) * b.take(_LAST, -1) - a.take(_LAST, -1) * b.take(_NEXT, -1))


def normalized(vectors: ArrayLike) -> FloatArray:
    """Return the vectors scaled to unit length.

    Args:
        vectors: vectors of any dimension and unit, shape ``(..., d)``.

    Returns:
        Unit vectors with the same directions, shape ``(..., d)``.

    Raises:
        ValueError: if a vector is zero or not finite.
    """
    array = np.asarray(vectors, dtype=np.float64)
    if array.ndim and 0 < array.size == array.shape[-1] <= singles.SHORT:
        return singles.normalized(array)
    # The division by the largest component prevents underflow and overflow of the squares.
    largest = np.max(np.abs(array), axis=-1, keepdims=True)
    if not np.all((largest > 0.0) & np.isfinite(largest)):
        raise ValueError("cannot normalise a vector that is zero or not finite")
    scaled = array / largest
    return np.asarray(scaled / np.sqrt(np.sum(scaled * scaled, axis=-1, keepdims=True)))


def quaternion_multiply(a: ArrayLike, b: ArrayLike) -> FloatArray:
    """Return Hamilton's product: the rotation by ``b`` followed by the rotation by ``a`` (Sola 2017, Sec. 1.2.2).

    Args:
        a: quaternions ``target_from_middle``, shape ``(..., 4)``.
        b: quaternions ``middle_from_source``, shape ``(..., 4)``.

    Returns:
        Products ``target_from_source``, with the broadcast shape ``(..., 4)``.

    Raises:
        ValueError: if a last dimension is not 4.
    """
    left, right = check_size(a, 4, "a"), check_size(b, 4, "b")
    if left.size == 4 and right.size == 4:
        return singles.multiply(left, right)
    return columns.multiply(left, right) if columns.is_large(left, right) else products(left, right, HAMILTON)


def quaternion_conjugate(quaternion: ArrayLike) -> FloatArray:
    """Return the conjugate. The conjugate of a unit quaternion is the inverse rotation (Sola 2017, Sec. 1.2.4).

    Args:
        quaternion: quaternions ``target_from_source``, shape ``(..., 4)``.

    Returns:
        Conjugates ``source_from_target``, shape ``(..., 4)``.

    Raises:
        ValueError: if the last dimension is not 4.
    """
    return np.asarray(check_size(quaternion, 4, "quaternion") * _CONJUGATION)


def rotate(quaternion: ArrayLike, vectors: ArrayLike) -> FloatArray:
    """Rotate vectors by unit quaternions, ``q v q*`` (Sola 2017, Sec. 2.4).

    Args:
        quaternion: unit quaternions ``target_from_source``, shape ``(..., 4)``.
        vectors: vectors in the source frame, in any unit, shape ``(..., 3)``.

    Returns:
        Vectors in the target frame, with the broadcast shape ``(..., 3)``.

    Raises:
        ValueError: if the last dimension of the quaternions is not 4 or the last dimension of the vectors is not 3.
    """
    unit, source = check_size(quaternion, 4, "quaternion"), check_size(vectors, 3, "vectors")
    if unit.size == 4 and singles.are_few(source):
        return singles.rotate(unit, source)
    if columns.is_large(unit, source):
        return columns.rotate(unit, source)
    terms = products(unit, unit, TURN) * source.take(EACH_ROW, -1)
    return np.asarray(source + terms @ ROW_SUMS)


def quaternion_from_rotation_vector(vector: ArrayLike) -> FloatArray:
    """Return the unit quaternions of rotation vectors, by the exponential map (Sola 2017, Eq. 101).

    Args:
        vector: rotation vectors [rad], shape ``(..., 3)``.

    Returns:
        Unit quaternions, shape ``(..., 4)``.

    Raises:
        ValueError: if the last dimension is not 3.
    """
    turns = check_size(vector, 3, "vector")
    if turns.size == 3:
        return singles.exponential(turns)
    half = 0.5 * turns
    # For a zero vector, the constant prevents 0 / 0. For other vectors, the constant is lost in rounding.
    half_angle = np.sqrt(_sum_squares(half) + 1e-60)[..., None]
    return columns.extended(np.sin(half_angle) / half_angle * half, np.cos(half_angle[..., 0]))


def quaternion_from_axis_angle(axis: ArrayLike, angle: ArrayLike, *, unit: bool = False) -> FloatArray:
    """Return the rotations about given axes by given angles (Sola 2017, Eq. 101).

    Args:
        axis: rotation axes of any non-zero length, shape ``(..., 3)``.
        angle: rotation angles [rad], shape ``(...)``.
        unit: whether the axes have unit length. If so, the function skips the normalisation, which is most of the work.

    Returns:
        Unit quaternions, with the broadcast shape ``(..., 4)``.

    Raises:
        ValueError: if an axis is zero or not finite, or if the last dimension of the axes is not 3.
    """
    unit_axis = check_size(axis, 3, "axis") if unit else normalized(check_size(axis, 3, "axis"))
    angles = np.asarray(angle, dtype=np.float64)
    if unit_axis.size == 3 and angles.size == 1:
        return singles.turn(unit_axis, angles)
    half_angle = 0.5 * angles[..., None]
    vector = np.sin(half_angle) * unit_axis
    return columns.extended(vector, np.cos(half_angle[..., 0]))


def quaternion_from_rpy(rpy: ArrayLike) -> FloatArray:
    """Return the rotation ``Rz(yaw) Ry(pitch) Rx(roll)``, as PyBullet's ``getQuaternionFromEuler`` does.

    Args:
        rpy: roll, pitch and yaw about the fixed x, y and z axes, in this order [rad], shape ``(..., 3)``.

    Returns:
        Unit quaternions, shape ``(..., 4)``.

    Raises:
        ValueError: if the last dimension is not 3.
    """
    angles = check_size(rpy, 3, "rpy")
    half = 0.5 * angles
    (cr, cp, cy), (sr, sp, sy) = np.moveaxis(np.cos(half), -1, 0), np.moveaxis(np.sin(half), -1, 0)
    # These are the components of the product of the three rotations.
    x, y = sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy
    z, w = cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy
    return np.stack([x, y, z, w], axis=-1)


def quaternion_of_rotation(matrix: ArrayLike) -> FloatArray:
    """Return the unit quaternion, shape ``(4,)``, of the rotation that is nearest to a matrix of shape ``(3, 3)``.

    The method is from Bar-Itzhack 2000, "New method for extracting the quaternion from a rotation matrix".
    """
    r = np.asarray(matrix, dtype=float)
    symmetric, skew = r + r.T, r - r.T
    around = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
    trace = np.trace(r)
    block = symmetric - np.eye(3) * trace
    _, vectors = np.linalg.eigh(np.block([[block, around[:, None]], [around[None, :], np.array([[trace]])]]))
    quaternion = vectors[:, -1]
    return np.asarray(quaternion if quaternion[3] >= 0 else -quaternion)


def rotation_vector(quaternion: ArrayLike) -> FloatArray:
    """Return the rotation vectors of unit quaternions, by the logarithmic map (Sola 2017, Sec. 2.4).

    Args:
        quaternion: unit quaternions, shape ``(..., 4)``.

    Returns:
        Rotation vectors of length at most pi [rad], shape ``(..., 3)``. For a half turn, two opposite vectors have
        length pi, and the sign of the quaternion selects the returned vector.

    Raises:
        ValueError: if the last dimension is not 4.
    """
    unit = check_size(quaternion, 4, "quaternion")
    if unit.size == 4:
        return singles.logarithm(unit)
    # q and -q represent the same rotation. The quaternion with w >= 0 has an angle of at most pi.
    unit = np.where(unit[..., 3:] < 0.0, -unit, unit)
    vector, scalar = unit[..., :3], unit[..., 3:]
    sine = np.sqrt(np.sum(vector * vector, axis=-1, keepdims=True))
    # For small angles, angle / sin(angle / 2) tends to 2. Below the threshold, the next term is lost in rounding.
    small = sine < singles.TINY
    factor = np.where(small, 2.0, 2.0 * np.arctan2(sine, scalar) / np.where(small, 1.0, sine))
    return np.asarray(factor * vector)


def integrate(quaternion: ArrayLike, angular_velocity: ArrayLike, dt: ArrayLike) -> FloatArray:
    """Return the exact orientations after a time step with constant angular velocity (Sola 2017, Sec. 4.6).

    Args:
        quaternion: initial orientations ``world_from_body``, shape ``(..., 4)``.
        angular_velocity: angular velocities in the world frame [rad/s], shape ``(..., 3)``.
        dt: time steps [s], shape ``(...)``.

    Returns:
        Final orientations as unit quaternions, with the broadcast shape ``(..., 4)``.

    Raises:
        ValueError: if a last dimension is wrong or a quaternion is zero.
    """
    before, speed = check_size(quaternion, 4, "quaternion"), check_size(angular_velocity, 3, "angular_velocity")
    time = np.asarray(dt, dtype=np.float64)
    if before.size == 4 and speed.size == 3 and time.ndim == 0:
        return singles.integrate(before, speed, float(time))
    product = quaternion_multiply(quaternion_from_rotation_vector(speed * time[..., None]), before)
    # Without normalisation, the length would drift over thousands of steps.
    square = _sum_squares(product)
    if not np.all(square > 0.0):
        raise ValueError("cannot normalise a quaternion that is zero or not finite")
    return np.asarray(product / np.sqrt(square)[..., None])
