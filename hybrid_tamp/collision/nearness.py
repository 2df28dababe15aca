"""Whether movements may come near bodies, by branch and bound on lower bounds of distances, without a library.

In contrast to `sweeps` and `meetings`, all pairs of poses are compared at once (`bounds`). So the answer is quick, and
imports nothing, if no movement comes near anything. If the answer is yes, the exact distance may still be large enough.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.collision.bounds import Poses, bound_distances
from hybrid_tamp.collision.sweeps import Track
from hybrid_tamp.motion.arrays import BoolArray, FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, quaternion_multiply

_SHORTEST = 1e-3
"""Path within two intervals that are not divided further [m]."""
_MOST = 40_000
"""Largest number of pairs of intervals that are compared at once."""
_NEARER = 1e-3
"""Amount by which bodies may come nearer than at the start before they part [m]."""


def may_come_near(one: Track, other: Track, within: float, compared: BoolArray | None = None) -> bool:
    """Return whether two bodies may come nearer to each other than a distance, at any two phases of their tracks.

    Args:
        one: track of a body.
        other: track of another body. A body at rest has a single pose.
        within: the distance [m]. Above `bounds.FAR`, the answer is yes more often than necessary.
        compared: which pairs of intervals between two poses count, shape ``(k, n)``. All pairs if None. The only pose
            of a body at rest counts as one interval.
    """
    mine, theirs = _Spans.of(one), _Spans.of(other)
    close = _bound_by_balls(mine, theirs) < within + one.body.reach + other.body.reach
    rows, columns = np.nonzero(close if compared is None else close & compared)
    mine, theirs = mine.at(rows), theirs.at(columns)
    while len(mine.radius):
        if len(mine.radius) > _MOST:
            return True
        bounds = bound_distances(one.body.shape, mine.middle, other.body.shape, theirs.middle)
        around = mine.radius + theirs.radius
        if np.any(bounds < within):
            return True
        near = np.flatnonzero(bounds - around < within)
        if np.any(around[near] < _SHORTEST):
            return True
        mine, theirs = _divide(mine.at(near), theirs.at(near))
    return False


def find_parted(track: Track, other: Track, within: float) -> int:
    """Return the first pose of a track at which two bodies are apart, if they come no nearer before.

    Bodies that are not near each other at the start are apart at pose 0.

    Args:
        track: track of a body.
        other: track of another body with as many poses, which are passed at the same times, or with a single pose.
        within: distance from which on the bodies are apart [m].

    Returns:
        The index of the pose. -1 if the bodies come nearer than at the start first, or never part.
    """
    count = len(track.positions)
    there = Poses(np.broadcast_to(other.positions, (count, 3)), np.broadcast_to(other.orientations, (count, 4)))
    bounds = bound_distances(track.body.shape, Poses(track.positions, track.orientations), other.body.shape, there)
    apart = np.flatnonzero(bounds >= within)
    parted = int(apart[0]) if len(apart) else -1
    return parted if np.all(bounds[: parted + 1] > bounds[0] - _NEARER) else -1


@dataclass(frozen=True, eq=False)
class _Spans:
    """Intervals between poses of a body. All poses in an interval are near its middle.

    Attributes:
        begin: poses at the beginnings.
        end: poses at the ends.
        radius: longest path of a point of the body from the middle of each interval to an end [m], shape ``(n,)``.
    """

    begin: Poses
    end: Poses
    radius: FloatArray

    @classmethod
    def of(cls, track: Track) -> "_Spans":
        """Return the intervals between the poses of a track, or a single pose as an interval."""
        poses = Poses(track.positions, track.orientations)
        count = len(track.positions)
        before, after = list(range(max(count - 1, 1))), list(range(min(count - 1, 1), count))
        begin, end = poses.at(before), poses.at(after)
        steps = np.linalg.norm(end.positions - begin.positions, axis=1)
        return cls(begin, end, (steps + track.body.reach * _turns(begin, end, axial=track.body.axial)) / 2.0)

    def at(self, rows: NDArray[np.intp]) -> "_Spans":
        """Return the intervals in some rows."""
        return _Spans(self.begin.at(rows), self.end.at(rows), self.radius[rows])

    @property
    def middle(self) -> Poses:
        """The poses in the middle of each interval."""
        one, other = self.begin.orientations, self.end.orientations
        sign = np.where(np.einsum("nk,nk->n", one, other) < 0.0, -1.0, 1.0)
        mixed = one + sign[:, None] * other
        turned = mixed / np.linalg.norm(mixed, axis=1, keepdims=True)
        return Poses((self.begin.positions + self.end.positions) / 2.0, turned)


def _bound_by_balls(mine: _Spans, theirs: _Spans) -> FloatArray:
    """Return lower bounds of the distances between the origins of two bodies in all pairs of intervals [m]."""
    apart = np.linalg.norm(mine.middle.positions[:, None] - theirs.middle.positions[None], axis=2)
    return np.asarray(apart - mine.radius[:, None] - theirs.radius[None])


def _divide(mine: _Spans, theirs: _Spans) -> tuple[_Spans, _Spans]:
    """Divide the longer one of the two intervals of each pair into halves."""
    longer = mine.radius >= theirs.radius
    return _halve(mine, longer), _halve(theirs, ~longer)


def _halve(spans: _Spans, where: BoolArray) -> _Spans:
    """Return all intervals twice. Where wanted, the two intervals are the halves."""
    middle, radius = spans.middle, np.where(where, spans.radius / 2.0, spans.radius)
    begin = _join(spans.begin, _choose(where, middle, spans.begin))
    end = _join(_choose(where, middle, spans.end), spans.end)
    return _Spans(begin, end, np.concatenate([radius, radius]))


def _choose(where: BoolArray, one: Poses, other: Poses) -> Poses:
    return Poses(
        np.where(where[:, None], one.positions, other.positions),
        np.where(where[:, None], one.orientations, other.orientations),
    )


def _join(one: Poses, other: Poses) -> Poses:
    return Poses(
        np.concatenate([one.positions, other.positions]), np.concatenate([one.orientations, other.orientations])
    )


def _turns(begin: Poses, end: Poses, *, axial: bool) -> FloatArray:
    """Return the angles of the turns ``(n,)`` [rad] or, if `axial`, the paths of the z axis on a unit sphere."""
    between = quaternion_multiply(quaternion_conjugate(begin.orientations), end.orientations)
    angles = 2.0 * np.arccos(np.minimum(np.abs(between[:, 3]), 1.0))
    if not axial:
        return np.asarray(angles)
    size = np.linalg.norm(between[:, :3], axis=1)
    return np.asarray(angles * np.hypot(between[:, 0], between[:, 1]) / np.maximum(size, 1e-12))
