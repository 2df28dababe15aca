"""Batched rotations as unit quaternions ``(x, y, z, w)``.

The equations are from Sola 2017, "Quaternion kinematics for the error-state Kalman filter" (arXiv:1711.02508). In
contrast to Sola, the scalar part of a quaternion comes last.
"""

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.motion import columns
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.component_products import EACH_ROW, HAMILTON, ROW_SUMS, TURN, products

_CONJUGATION = np.array([-1.0, -1.0, -1.0, 1.0])
_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])


def _array(values: ArrayLike, size: int, name: str) -> FloatArray:
    array = np.asarray(values, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != size:
        raise ValueError(f"{name} must have shape (..., {size}), got {array.shape}")
    return array


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cross products of vectors ``(..., 3)``, several times as fast as `numpy.cross`."""
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
    left, right = _array(a, 4, "a"), _array(b, 4, "b")
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
    return np.asarray(_array(quaternion, 4, "quaternion") * _CONJUGATION)


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
    unit, source = _array(quaternion, 4, "quaternion"), _array(vectors, 3, "vectors")
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
    half = 0.5 * _array(vector, 3, "vector")
    # For a zero vector, the constant prevents 0 / 0. For other vectors, the constant is lost in rounding.
    half_angle = np.sqrt(np.einsum("...i,...i->...", half, half) + 1e-60)[..., None]
    return np.concatenate([np.sin(half_angle) / half_angle * half, np.cos(half_angle)], axis=-1)


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
    unit_axis = _array(axis, 3, "axis") if unit else normalized(_array(axis, 3, "axis"))
    half_angle = 0.5 * np.asarray(angle, dtype=np.float64)[..., None]
    vector = np.sin(half_angle) * unit_axis
    return np.concatenate([vector, np.cos(half_angle) + np.zeros_like(vector[..., :1])], axis=-1)


def quaternion_from_rpy(rpy: ArrayLike) -> FloatArray:
    """Return the rotation ``Rz(yaw) Ry(pitch) Rx(roll)``, as PyBullet's ``getQuaternionFromEuler`` does.

    Args:
        rpy: roll, pitch and yaw about the fixed x, y and z axes, in this order [rad], shape ``(..., 3)``.

    Returns:
        Unit quaternions, shape ``(..., 4)``.

    Raises:
        ValueError: if the last dimension is not 3.
    """
    angles = _array(rpy, 3, "rpy")
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
    unit = _array(quaternion, 4, "quaternion")
    # q and -q represent the same rotation. The quaternion with w >= 0 has an angle of at most pi.
    unit = np.where(unit[..., 3:] < 0.0, -unit, unit)
    vector, scalar = unit[..., :3], unit[..., 3:]
    sine = np.sqrt(np.sum(vector * vector, axis=-1, keepdims=True))
    # For small angles, angle / sin(angle / 2) tends to 2. Below the threshold, the next term is lost in rounding.
    small = sine < 1e-9
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
    turn = _array(angular_velocity, 3, "angular_velocity") * np.asarray(dt, dtype=np.float64)[..., None]
    product = quaternion_multiply(quaternion_from_rotation_vector(turn), quaternion)
    # Without normalisation, the length would drift over thousands of steps.
    square = np.einsum("...i,...i->...", product, product)
    if not np.all(square > 0.0):
        raise ValueError("cannot normalise a quaternion that is zero or not finite")
    return np.asarray(product / np.sqrt(square)[..., None])


def angle_about(axis: ArrayLike, quaternions: ArrayLike) -> FloatArray:
    """Return the accumulated rotation angle about a body-fixed axis. The angle is not wrapped.

    The angle is the integral of the angular velocity's component along the axis. The function sums the rotations
    between consecutive samples, projected on the axis. Between two samples, the angle must be below pi.

    Args:
        axis: axis in the body frame, of any non-zero length, shape ``(..., 3)``.
        quaternions: time series of orientations ``world_from_body``, shape ``(t, ..., 4)``.

    Returns:
        Right-handed angles about the axis [rad], shape ``(t, ...)``. The first angle is 0.

    Raises:
        ValueError: if the axis is zero, if a last dimension is wrong, or if there is no time dimension.
    """
    series, unit_axis = _array(quaternions, 4, "quaternions"), normalized(_array(axis, 3, "axis"))
    if series.ndim < 2 or len(series) == 0:
        raise ValueError(f"quaternions must have shape (t, ..., 4) with t at least 1, got {series.shape}")
    # If the axis has more batch dimensions than the series, the missing dimensions are inserted after the time.
    missing = max(0, unit_axis.ndim + 1 - series.ndim)
    series = series.reshape(len(series), *(1,) * missing, *series.shape[1:])
    before_from_after = quaternion_multiply(quaternion_conjugate(series[:-1]), series[1:])
    steps = np.sum(rotation_vector(before_from_after) * unit_axis, axis=-1)
    return np.concatenate([np.zeros((1, *steps.shape[1:])), np.cumsum(steps, axis=0)])
