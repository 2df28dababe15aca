"""Whether two movements meet, in any timing or if they start together, by branch and bound on distances.

The poses of a movement within an interval of phases are near the pose in the middle of the interval: no point of the
body is farther away than the path on the longer side. So the distance in the middle of two intervals bounds the
distances between all pairs of poses in them.
"""

import heapq

import numpy as np

from hybrid_tamp.collision.bodies import bound_distance, find_nearest
from hybrid_tamp.collision.sweeps import Track
from hybrid_tamp.motion.arrays import FloatArray

_MOST = 4000
"""Largest number of pairs of poses that are compared."""
_SHORTEST = 2e-3
"""Path of an interval that is not divided further [m]."""

_Interval = tuple[float, float]
"""First and last phase of an interval."""


def meet(one: Track, other: Track, allowed: float = 0.0) -> bool:
    """Return whether the least distance between two moving bodies can be below a limit, in any timing.

    If the comparison of `_MOST` pairs of poses does not exclude a meeting, the movements count as meeting.

    Args:
        one: a movement.
        other: another movement.
        allowed: the limit [m]. Negative for bodies that may touch.
    """
    travelled = _travelled(one), _travelled(other)
    whole = (0.0, len(one.positions) - 1.0), (0.0, len(other.positions) - 1.0)
    waiting: list[tuple[float, _Interval, _Interval]] = [(-np.inf, *whole)]
    for _ in range(_MOST):
        if not waiting:
            return False
        _, mine, theirs = heapq.heappop(waiting)
        middle, opposite = sum(mine) / 2.0, sum(theirs) / 2.0
        around = _radius(travelled[0], mine), _radius(travelled[1], theirs)
        at, there = one.at(middle), other.at(opposite)
        distance = bound_distance(one.body, at, other.body, there)
        if distance - sum(around) >= allowed:
            continue
        distance = find_nearest(one.body, at, other.body, there).distance
        if distance < allowed:
            return True
        if distance - sum(around) >= allowed or max(around) < _SHORTEST:
            continue
        split = (_halves(mine), (theirs,)) if around[0] >= around[1] else ((mine,), _halves(theirs))
        for first in split[0]:
            for second in split[1]:
                heapq.heappush(waiting, (distance - sum(around), first, second))
    return True


def meet_together(one: Track, other: Track, allowed: float = 0.0) -> bool:
    """Return whether the least distance between two bodies can be below a limit if both movements start together.

    The poses of both tracks must be equally spaced in time. A body that arrives first waits at the end of its track.

    Args:
        one: a movement.
        other: another movement.
        allowed: the limit [m]. Negative for bodies that may touch.
    """
    ends = len(one.positions) - 1.0, len(other.positions) - 1.0
    travelled = _travelled(one), _travelled(other)
    waiting: list[_Interval] = [(0.0, max(ends))]
    while waiting:
        interval = waiting.pop()
        middle = sum(interval) / 2.0
        at, there = one.at(min(middle, ends[0])), other.at(min(middle, ends[1]))
        around = _radius(travelled[0], interval) + _radius(travelled[1], interval)
        if bound_distance(one.body, at, other.body, there) - around >= allowed:
            continue
        distance = find_nearest(one.body, at, other.body, there).distance
        if distance < allowed:
            return True
        if distance - around < allowed and around >= _SHORTEST:
            waiting += _halves(interval)
    return False


def _halves(interval: _Interval) -> tuple[_Interval, _Interval]:
    begin, end = interval
    return (begin, (begin + end) / 2.0), ((begin + end) / 2.0, end)


def _travelled(track: Track) -> FloatArray:
    """Return the longest path of a point of the body from the start to each pose [m], shape ``(k,)``."""
    steps = [track.bound(index, index + 1.0) for index in range(len(track.positions) - 1)]
    return np.concatenate([[0.0], np.cumsum(steps)])


def _radius(travelled: FloatArray, interval: _Interval) -> float:
    """Return the longest path of a point of the body from the middle of an interval to one of its ends [m]."""
    begin, end = interval
    phases = np.arange(len(travelled), dtype=np.float64)
    first, middle, last = np.interp([begin, (begin + end) / 2.0, end], phases, travelled)
    return float(max(middle - first, last - middle))
