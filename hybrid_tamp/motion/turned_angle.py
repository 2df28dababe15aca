"""The angle by which a body has turned about one of its axes in a time series of orientations."""

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import check_size, normalized, quaternion_conjugate, quaternion_multiply, rotation_vector


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
    series, unit_axis = check_size(quaternions, 4, "quaternions"), normalized(check_size(axis, 3, "axis"))
    if series.ndim < 2 or len(series) == 0:
        raise ValueError(f"quaternions must have shape (t, ..., 4) with t at least 1, got {series.shape}")
    # If the axis has more batch dimensions than the series, the missing dimensions are inserted after the time.
    missing = max(0, unit_axis.ndim + 1 - series.ndim)
    series = series.reshape(len(series), *(1,) * missing, *series.shape[1:])
    before_from_after = quaternion_multiply(quaternion_conjugate(series[:-1]), series[1:])
    steps = np.sum(rotation_vector(before_from_after) * unit_axis, axis=-1)
    return np.concatenate([np.zeros((1, *steps.shape[1:])), np.cumsum(steps, axis=0)])
