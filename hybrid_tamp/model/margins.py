"""Rounding errors of margins. A margin that is negative by rounding only must not decide whether a condition holds."""

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray

ROUNDING = 1e-9
"""Largest margin that counts as zero, as a fraction of the scale of its predicate.

Rounding errors of a margin are about 1e-16 times its terms, so they stay below 1e-9 scales unless a term is larger than
1e6 scales. A difference of 1e-9 scales is far below every tolerance and every measurement.
"""


def without_rounding(margin: FloatArray, scale: float) -> FloatArray:
    """Return a margin ``(...)`` in which each value that differs from zero by rounding only is exactly zero.

    Args:
        margin: signed margin ``(...)`` [unit].
        scale: scale of the predicate [unit].
    """
    return np.where(np.abs(margin) <= ROUNDING * scale, 0.0, margin)
