"""Movements along a planned path, with rounded corners and a speed profile of their own."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.curves import Curve
from hybrid_tamp.skills.primitives import Reference, straight_profile

Share = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Maps the elapsed time ``(...)`` [s] to the share of a turn and the rate of this share [1/s], each ``(...)``."""
MEAN_SPEED = 0.4
"""Largest mean speed along a planned path [m/s]."""


class Travel(NamedTuple):
    """A movement along a path.

    Attributes:
        reference: reference of the position.
        turned: share of the turn on the way.
        duration: duration of the movement ``(...)`` [s].
    """

    reference: Reference
    turned: Share
    duration: FloatArray


def curve_along(start: FloatArray, path: FloatArray | None, goal: FloatArray) -> Curve:
    """Return the curve from start to goal, each ``(..., 3)`` [m], along the inner corners of a path ``(c, 3)`` [m].

    Without a path, the curve is straight.
    """
    ends = start[..., None, :], goal[..., None, :]
    inner = [] if path is None else [np.broadcast_to(path[1:-1], (*start.shape[:-1], len(path) - 2, 3))]
    return Curve.through(np.concatenate([ends[0], *inner, ends[1]], axis=-2))


def follow_path(
    start: FloatArray, path: FloatArray, goal: FloatArray, duration: FloatArray, angle: FloatArray | float = 0.0
) -> Travel:
    """Return the movement along a path.

    Only the duration changes the speed, so no speed can make the movement leave the path. The body turns between the
    second corner of the path and the last but one.

    Args:
        start: initial position ``(..., 3)`` [m], which replaces the first corner of the path.
        path: corners of the path ``(c, 3)`` [m].
        goal: final position ``(..., 3)`` [m], which replaces the last corner of the path.
        duration: duration ``(...)`` [s]. A movement whose mean speed would exceed `MEAN_SPEED` lasts longer.
        angle: angle of the turn ``(...)`` [rad].
    """
    turns = bool(np.any(np.asarray(angle) > 0.0))
    corners = _with_inner_corners(path) if turns else path
    curve = curve_along(start, corners, goal)
    if turns:
        curve = curve.turning_within(np.asarray(angle), len(corners))
    time = np.asarray(np.maximum(duration, curve.length / MEAN_SPEED))
    profile = straight_profile()
    return Travel(
        lambda elapsed: curve.at(elapsed, time, profile), lambda elapsed: curve.turned(elapsed, time, profile), time
    )


def _with_inner_corners(path: FloatArray) -> FloatArray:
    """Return a path ``(c, 3)`` [m] with at least two inner corners, between which a body can turn."""
    while len(path) < 4:
        path = np.insert(path, len(path) - 1, path[-2:].mean(axis=0), axis=0)
    return path
