"""Intervals of phases of a movement, and the paths of a body within them.

The poses within an interval are near the pose in its middle: no point of the body is farther away than the path on the
longer side.
"""

import numpy as np

from hybrid_tamp.collision.sweeps import Track
from hybrid_tamp.motion.arrays import FloatArray

Interval = tuple[float, float]
"""First and last phase of an interval."""
SHORTEST = 2e-3
"""Path of an interval that is not divided further [m]."""


def halve(interval: Interval) -> tuple[Interval, Interval]:
    """Return the two halves of an interval."""
    begin, end = interval
    return (begin, (begin + end) / 2.0), ((begin + end) / 2.0, end)


def find_travelled(track: Track) -> FloatArray:
    """Return the longest path of a point of the body from the start to each pose [m], shape ``(k,)``."""
    steps = [track.bound(index, index + 1.0) for index in range(len(track.positions) - 1)]
    return np.concatenate([[0.0], np.cumsum(steps)])


def find_radius(travelled: FloatArray, interval: Interval) -> float:
    """Return the longest path of a point of the body from the middle of an interval to one of its ends [m]."""
    begin, end = interval
    phases = np.arange(len(travelled), dtype=np.float64)
    first, middle, last = np.interp([begin, (begin + end) / 2.0, end], phases, travelled)
    return float(max(middle - first, last - middle))
