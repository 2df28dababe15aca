"""Movements along a planned path, with rounded corners and a speed profile of their own."""

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.curves import Curve
from hybrid_tamp.skills.primitives import Reference, straight_profile

MEAN_SPEED = 0.4
"""Largest mean speed along a planned path [m/s]."""


def curve_along(start: FloatArray, path: FloatArray | None, goal: FloatArray) -> Curve:
    """Return the curve from start to goal, each ``(..., 3)`` [m], along the inner corners of a path ``(c, 3)`` [m].

    Without a path, the curve is straight.
    """
    ends = start[..., None, :], goal[..., None, :]
    inner = [] if path is None else [np.broadcast_to(path[1:-1], (*start.shape[:-1], len(path) - 2, 3))]
    return Curve.through(np.concatenate([ends[0], *inner, ends[1]], axis=-2))


def follow_path(
    start: FloatArray, path: FloatArray, goal: FloatArray, duration: FloatArray
) -> tuple[Reference, FloatArray]:
    """Return the reference of a movement along a path, and the duration of the movement ``(...)`` [s].

    Only the duration changes the speed, so no speed can make the movement leave the path.

    Args:
        start: initial position ``(..., 3)`` [m], which replaces the first corner of the path.
        path: corners of the path ``(c, 3)`` [m].
        goal: final position ``(..., 3)`` [m], which replaces the last corner of the path.
        duration: duration ``(...)`` [s]. A movement whose mean speed would exceed `MEAN_SPEED` lasts longer.
    """
    curve = curve_along(start, path, goal)
    time = np.asarray(np.maximum(duration, curve.length / MEAN_SPEED))
    profile = straight_profile()
    return lambda elapsed: curve.at(elapsed, time, profile), time
