"""Paths of bodies that turn on the way, although there is no room for the turn at the start or at the goal.

A hand that starts beside a box must move away from the box before it turns, and approaches its goal after it has
turned. So the first leg of the path is free for the first orientations, and the last leg is free for the last ones.
Between these legs, the path is free for all orientations of the movement, and the bodies turn there.
"""

from collections.abc import Iterator
from itertools import product

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.paths.free_space import FreeSpace, OutOfChecks
from hybrid_tamp.paths.search import find_path

_LEGS = (0.04, 0.08, 0.14, 0.22, 0.32, 0.45)
"""Lengths of the first and the last leg that are tried [m]."""


def find_turning_path(
    turning: FreeSpace,
    ends: tuple[FreeSpace, FreeSpace],
    start: FloatArray,
    goal: FloatArray,
    box: tuple[FloatArray, FloatArray],
    seed: int,
) -> FloatArray | None:
    """Return the corners ``(c, 3)`` [m] of a path, at least 4, or None if the search finds no path.

    The bodies turn between the second corner and the last but one.

    Args:
        turning: free space of the bodies in all orientations of the movement.
        ends: free spaces of the bodies in their first orientations and in their last orientations.
        start: position ``(3,)`` [m] at which the path begins.
        goal: position ``(3,)`` [m] at which the path ends.
        box: lower and upper corners ``(3,)`` of the box that contains all samples [m].
        seed: seed of the query.
    """
    try:
        leave, enter = (_find_room(turning, *end) for end in zip(ends, (start, goal), strict=True))
    except OutOfChecks:
        return None
    if leave is None or enter is None:
        return None
    middle = find_path(turning, leave, enter, *box, seed)
    return None if middle is None else np.concatenate([start[None], middle, goal[None]])


def _find_room(turning: FreeSpace, space: FreeSpace, place: FloatArray) -> FloatArray | None:
    """Return the nearest position ``(3,)`` [m] with room for the turn that a straight leg connects with a place."""
    if turning.slack(place) > 0.0:
        return place
    for length in _LEGS:
        for direction in directions_upwards():
            there = place + length * direction
            if turning.slack(there) > 0.0 and space.is_free(place, there):
                return np.asarray(there)
    return None


def directions_upwards() -> Iterator[FloatArray]:
    """Yield unit vectors ``(3,)``: upwards, then to the sides, edges and corners of a cube that are not below."""
    yield np.array([0.0, 0.0, 1.0])
    for steps in product((0.0, 1.0), (-1.0, 0.0, 1.0), (-1.0, 0.0, 1.0)):
        direction = np.array([steps[1], steps[2], steps[0]])
        if steps[1] or steps[2]:
            yield direction / np.linalg.norm(direction)
