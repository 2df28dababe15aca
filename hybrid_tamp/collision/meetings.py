"""Whether two movements meet, in any timing or if they start together, by branch and bound on distances.

The poses within an interval of phases are near the pose in its middle (`intervals`). So the distance in the middle of
two intervals bounds the distances between all pairs of poses in them.
"""

import heapq

import numpy as np

from hybrid_tamp.collision.bodies import bound_distance, find_nearest
from hybrid_tamp.collision.intervals import SHORTEST, Interval, find_radius, find_travelled, halve
from hybrid_tamp.collision.sweeps import Track

_MOST = 4000
"""Largest number of pairs of poses that are compared."""


def meet(one: Track, other: Track, allowed: float = 0.0) -> bool:
    """Return whether the least distance between two moving bodies can be below a limit, in any timing.

    If the comparison of `_MOST` pairs of poses does not exclude a meeting, the movements count as meeting.

    Args:
        one: a movement.
        other: another movement.
        allowed: the limit [m]. Negative for bodies that may touch.
    """
    travelled = find_travelled(one), find_travelled(other)
    whole = (0.0, len(one.positions) - 1.0), (0.0, len(other.positions) - 1.0)
    waiting: list[tuple[float, Interval, Interval]] = [(-np.inf, *whole)]
    for _ in range(_MOST):
        if not waiting:
            return False
        _, mine, theirs = heapq.heappop(waiting)
        middle, opposite = sum(mine) / 2.0, sum(theirs) / 2.0
        around = find_radius(travelled[0], mine), find_radius(travelled[1], theirs)
        at, there = one.at(middle), other.at(opposite)
        distance = bound_distance(one.body, at, other.body, there)
        if distance - sum(around) >= allowed:
            continue
        distance = find_nearest(one.body, at, other.body, there).distance
        if distance < allowed:
            return True
        if distance - sum(around) >= allowed or max(around) < SHORTEST:
            continue
        split = (halve(mine), (theirs,)) if around[0] >= around[1] else ((mine,), halve(theirs))
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
    travelled = find_travelled(one), find_travelled(other)
    waiting: list[Interval] = [(0.0, max(ends))]
    while waiting:
        interval = waiting.pop()
        middle = sum(interval) / 2.0
        at, there = one.at(min(middle, ends[0])), other.at(min(middle, ends[1]))
        around = find_radius(travelled[0], interval) + find_radius(travelled[1], interval)
        if bound_distance(one.body, at, other.body, there) - around >= allowed:
            continue
        distance = find_nearest(one.body, at, other.body, there).distance
        if distance < allowed:
            return True
        if distance - around < allowed and around >= SHORTEST:
            waiting += halve(interval)
    return False
