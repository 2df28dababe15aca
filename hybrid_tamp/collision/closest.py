"""The least distance of a moving body from several bodies at rest, by branch and bound on distances.

In contrast to `sweeps.find_clearance`, which compares every pose of a movement, the search begins with whole movements
and divides only the intervals in which a body may be nearer than the nearest one so far.
"""

import heapq
from collections.abc import Sequence

import numpy as np

from hybrid_tamp.collision.bodies import Body, Pose, bound_distance, find_nearest
from hybrid_tamp.collision.intervals import SHORTEST, Interval, find_radius, find_travelled, halve
from hybrid_tamp.collision.sweeps import PRECISION, Clearance, Track

_ROUGH = 0.05
"""Precision with which bodies are compared with each other, as a fraction of the distance."""


def find_closest(track: Track, others: Sequence[tuple[Body, Pose]], limit: float = np.inf) -> Clearance | None:
    """Return the least distance of a moving body from bodies at rest, or None if all distances are above the limit.

    The distance from the found body is larger than the least one by at most 1 mm. Another body may be nearer by at most
    1 mm or 5 % of the distance, whichever is larger.

    Args:
        track: track of the moving body.
        others: bodies at rest with their poses.
        limit: largest distance of interest [m].
    """
    found = _search(track, others, limit, _ROUGH)
    if found is None or _ROUGH * found.distance <= PRECISION:
        return found
    nearest = [(body, pose) for body, pose in others if body.name == found.other]
    return _search(track, nearest, found.distance, 0.0) or found


def _search(track: Track, others: Sequence[tuple[Body, Pose]], limit: float, share: float) -> Clearance | None:
    """Return a distance below the limit that is nearly the least one, or None if there is none.

    The precision is 1 mm or the given share of the distance, whichever is larger.
    """
    last, travelled = len(track.positions) - 1.0, find_travelled(track)
    best: Clearance | None = None
    waiting: list[tuple[float, int, Interval]] = []

    def improve(index: int, phase: float, around: float) -> float:
        """Return a lower bound of the distance from a body on an interval. Keep the distance if it is the least."""
        nonlocal best
        most = limit if best is None else best.distance
        (body, there), at = others[index], track.at(phase)
        bound = bound_distance(track.body, at, body, there)
        if bound - around >= most:
            return bound - around
        distance = find_nearest(track.body, at, body, there).distance
        if distance < most:
            best = Clearance(distance, phase, track.body.name, body.name)
        return distance - around

    for index, other in enumerate(others):
        improve(index, 0.0, 0.0)
        improve(index, last, 0.0)
        heapq.heappush(waiting, (track.bound_distance(*other), index, (0.0, last)))
    while waiting:
        bound, index, interval = heapq.heappop(waiting)
        most = limit if best is None else best.distance
        if bound >= most - max(PRECISION, share * most):
            break
        around = find_radius(travelled, interval)
        bound = improve(index, sum(interval) / 2.0, around)
        if around >= SHORTEST:
            for half in halve(interval):
                heapq.heappush(waiting, (bound, index, half))
    return best
