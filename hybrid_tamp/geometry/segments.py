"""Nearest points on line segments."""

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.motion.arrays import FloatArray


def nearest_on_segment(points: ArrayLike, begin: ArrayLike, end: ArrayLike) -> FloatArray:
    """Return the nearest point on each line segment to a given point.

    Args:
        points: given points [m], shape ``(..., 3)``.
        begin: first end of each segment [m], shape ``(..., 3)``.
        end: second end of each segment [m], shape ``(..., 3)``. A segment can have length zero.

    Returns:
        Nearest points on the segments [m], with the broadcast shape ``(..., 3)``.
    """
    begin = np.asarray(begin, dtype=np.float64)
    along = np.asarray(end, dtype=np.float64) - begin
    square = np.sum(along * along, axis=-1)
    share = np.sum((np.asarray(points) - begin) * along, axis=-1) / np.where(square > 0.0, square, 1.0)
    return np.asarray(begin + np.clip(share, 0.0, 1.0)[..., None] * along)
