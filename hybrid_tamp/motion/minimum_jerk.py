"""The minimum-jerk profile from rest to rest (Flash and Hogan 1985, J. Neurosci. 5:1688-1703, Eq. 3)."""

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.motion.arrays import FloatArray


def _clipped(phase: ArrayLike) -> FloatArray:
    return np.clip(np.asarray(phase, dtype=np.float64), 0.0, 1.0)


def minimum_jerk(phase: ArrayLike) -> FloatArray:
    """Return the travelled fraction of the distance, ``10 p^3 - 15 p^4 + 6 p^5`` (Flash and Hogan 1985).

    Args:
        phase: elapsed time divided by duration, shape ``(...)``. Values are clipped to [0, 1].

    Returns:
        Fraction of the distance from 0 to 1, shape ``(...)``.
    """
    p = _clipped(phase)
    return np.asarray(p**3 * (10.0 + p * (6.0 * p - 15.0)))


def minimum_jerk_rate(phase: ArrayLike) -> FloatArray:
    """Return the first derivative of the profile, ``30 p^2 (1 - p)^2`` (Flash and Hogan 1985).

    The product with distance / duration is the speed [m/s]. The maximum of the derivative is 15/8, at p = 0.5.

    Args:
        phase: elapsed time divided by duration, shape ``(...)``.

    Returns:
        Derivative with respect to the phase, shape ``(...)``. The derivative is 0 outside [0, 1].
    """
    p = _clipped(phase)
    return np.asarray(30.0 * (p * (1.0 - p)) ** 2)


def minimum_jerk_acceleration(phase: ArrayLike) -> FloatArray:
    """Return the second derivative of the profile, ``60 p (1 - p) (1 - 2 p)`` (Flash and Hogan 1985).

    The product with distance / duration^2 is the acceleration [m/s^2].

    Args:
        phase: elapsed time divided by duration, shape ``(...)``.

    Returns:
        Second derivative with respect to the phase, shape ``(...)``. The derivative is 0 outside [0, 1].
    """
    p = _clipped(phase)
    return np.asarray(60.0 * p * (1.0 - p) * (1.0 - 2.0 * p))
