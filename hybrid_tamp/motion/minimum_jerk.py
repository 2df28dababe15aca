"""The minimum-jerk profile from rest to rest (Flash and Hogan 1985, J. Neurosci. 5:1688-1703, Eq. 3)."""

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.motion.arrays import FloatArray


def _clipped(phase: ArrayLike) -> FloatArray:
    return np.clip(np.asarray(phase, dtype=np.float64), 0.0, 1.0)


def minimum_jerk(phase: ArrayLike) -> FloatArray:
    """Return the travelled share of the way, ``10 p^3 - 15 p^4 + 6 p^5`` (Flash and Hogan 1985).

    Args:
        phase: elapsed time over duration, shape ``(...)``; clipped to [0, 1].

    Returns:
        Share of the way, from 0 to 1, shape ``(...)``.
    """
    p = _clipped(phase)
    return np.asarray(p**3 * (10.0 + p * (6.0 * p - 15.0)))


def minimum_jerk_rate(phase: ArrayLike) -> FloatArray:
    """Return the first derivative of the profile, ``30 p^2 (1 - p)^2`` (Flash and Hogan 1985).

    Times distance over duration it is the speed [m/s]; its peak is 15/8, half-way.

    Args:
        phase: elapsed time over duration, shape ``(...)``.

    Returns:
        Derivative by phase, shape ``(...)``; 0 outside [0, 1].
    """
    p = _clipped(phase)
    return np.asarray(30.0 * (p * (1.0 - p)) ** 2)


def minimum_jerk_acceleration(phase: ArrayLike) -> FloatArray:
    """Return the second derivative of the profile, ``60 p (1 - p) (1 - 2 p)`` (Flash and Hogan 1985).

    Times distance over squared duration it is the acceleration [m/s^2].

    Args:
        phase: elapsed time over duration, shape ``(...)``.

    Returns:
        Second derivative by phase, shape ``(...)``; 0 outside [0, 1].
    """
    p = _clipped(phase)
    return np.asarray(60.0 * p * (1.0 - p) * (1.0 - 2.0 * p))
