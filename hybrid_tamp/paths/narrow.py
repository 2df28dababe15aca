"""Narrow places: how close bodies may come there, and corners that stay clear of bodies when they are rounded."""

from itertools import pairwise

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.curves import round_corners
from hybrid_tamp.motion.poses import cross
from hybrid_tamp.paths.free_space import FreeSpace

SMALLEST_MARGIN = 0.003
"""Smallest distance from other bodies on a path through a narrow place [m], as an allowance for servo errors."""
_FARTHEST = 0.1
"""Largest displacement of a narrow place [m]."""
_STEPS = (0.04, 0.02, 0.01, 0.005, 0.0025)
"""Steps of the search for the widest position [m]."""
_SHARE = 0.5
"""Ratio of the kept distance to the largest one in a narrow place. The rest is room for the search."""
_REFINEMENTS = 3
"""Largest number of times that corners are added."""


def find_widest(space: FreeSpace, place: FloatArray, direction: FloatArray) -> tuple[FloatArray, FreeSpace | None]:
    """Return the position ``(3,)`` [m] with the most room beside a narrow place, and the free space for a path there.

    Positions beside the place differ perpendicular to the direction of the way, so they do not leave a short gap. If
    the room is small, the margins of this free space are smaller than usual. The free space is None if the bodies do
    not fit.

    Args:
        space: the free space.
        place: a narrow place ``(3,)`` [m].
        direction: direction of the way there, a unit vector ``(3,)``.

    Raises:
        OutOfChecks: the largest number of checks is reached.
    """
    touching = space.narrowed(0.0)
    aside = cross(direction, np.eye(3)[np.abs(direction).argmin()])
    aside /= float(np.linalg.norm(aside))
    ways = np.array([aside, cross(direction, aside)])
    best, room = place, touching.slack(place)
    for step in _STEPS:
        better = True
        while better:
            better = False
            for way in (*ways, *-ways):
                other = best + step * way
                if np.linalg.norm(other - place) <= _FARTHEST and (found := touching.slack(other)) > room:
                    best, room, better = other, found, True
    if _SHARE * room < SMALLEST_MARGIN:
        return best, None
    return best, space.narrowed(_SHARE * room)


def refine_corners(space: FreeSpace, path: FloatArray) -> FloatArray:
    """Return the corners ``(n, 3)`` [m] of the same path with more corners where a rounded corner would hit a body.

    Raises:
        OutOfChecks: the largest number of checks is reached.
    """
    for _ in range(_REFINEMENTS):
        refined = [path[:1]]
        for before, corner, after in zip(path[:-2], path[1:-1], path[2:], strict=True):
            rounded = round_corners(np.array([before, corner, after]))[1:-1]
            if all(space.is_free(one, other) for one, other in pairwise(rounded)):
                refined.append(corner[None])
            else:
                # The rounding replaces at most half of each leg.
                refined.append(np.array([(before + 3.0 * corner) / 4.0, corner, (3.0 * corner + after) / 4.0]))
        refined.append(path[-1:])
        if len(path) == sum(map(len, refined)):
            break
        path = np.concatenate(refined)
    return path
