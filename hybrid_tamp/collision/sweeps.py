"""Least distances during movements, by bisection on distances.

Between two poses, no point of a body moves farther than ``|dx| + r |dangle|``, where r is the reach of the body. A turn
of a cylinder about its axis does not count. So the distance on an interval is at least ``(d0 + d1 - |dx| - r |dangle|)
/ 2``, where d0 and d1 are the distances at its ends. The interval with the least bound is divided until no bound is
much below the least distance that was found. In contrast to samples at fixed steps, this search misses no contact.
"""

import heapq
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import acos, hypot, sin

import numpy as np

from hybrid_tamp.collision.bodies import Body, Pose, bound_distance, find_nearest
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, quaternion_multiply

FLOOR = "(floor)"
"""Name of the floor among the bodies that a movement may come near to."""
PRECISION = 1e-3
"""Default precision of a least distance [m]."""

_TINY = 1e-6
"""Angle below which the axis of a turn is not computed [rad]."""


@dataclass(frozen=True, eq=False)
class Track:
    """The poses of a body along a movement. Between two poses, position and orientation change uniformly.

    Attributes:
        body: body that moves.
        positions: positions [m], shape ``(k, 3)`` with at least one pose.
        orientations: orientations as unit quaternions, shape ``(k, 4)``.
    """

    body: Body
    positions: FloatArray
    orientations: FloatArray

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase from 0 to k - 1."""
        index = min(int(phase), max(len(self.positions) - 2, 0))
        if len(self.positions) == 1:
            return Pose(self.positions[0], self.orientations[0])
        share = phase - index
        position = (1.0 - share) * self.positions[index] + share * self.positions[index + 1]
        return Pose(position, _between(self.orientations[index], self.orientations[index + 1], share))

    def beginning_at(self, index: int) -> "Track":
        """Return the part of the track from one of its poses on."""
        return Track(self.body, self.positions[index:], self.orientations[index:])

    @cached_property
    def corners(self) -> FloatArray:
        """Lower and upper corner of the box around all positions [m], shape ``(2, 3)``."""
        return np.array([self.positions.min(axis=0), self.positions.max(axis=0)])

    def bound_distance(self, other: Body, there: Pose) -> float:
        """Return a lower bound of the distance from a body at rest during the whole movement [m]."""
        lower, upper = self.corners
        outside = np.maximum(np.maximum(lower - there.position, there.position - upper), 0.0)
        return float(np.linalg.norm(outside)) - self.body.reach - other.reach

    def bound(self, begin: float, end: float) -> float:
        """Return an upper bound of the path of the body between two phases of one interval [m].

        The path is that of any point of the body or, for a cylinder, of any point that does not turn about the axis.
        """
        index = min(int(begin), max(len(self.positions) - 2, 0))
        if len(self.positions) == 1:
            return 0.0
        step = float(np.linalg.norm(self.positions[index + 1] - self.positions[index]))
        turn = _turn_between(self.orientations[index], self.orientations[index + 1], self.body.axial)
        return (end - begin) * (step + self.body.reach * turn)


@dataclass(frozen=True)
class Clearance:
    """The least distance during a movement.

    Attributes:
        distance: distance [m], negative if the bodies overlap.
        phase: phase of the movement at this distance, from 0 to the number of poses minus 1.
        moving: name of the moving body.
        other: name of the other body, or `FLOOR`.
    """

    distance: float
    phase: float
    moving: str
    other: str


def find_clearance(
    tracks: Iterable[Track],
    others: Sequence[tuple[Body, Pose]],
    *,
    floor: bool = False,
    limit: float = np.inf,
    precision: float = PRECISION,
) -> Clearance | None:
    """Return the least distance of moving bodies from bodies at rest, or None if all distances are above the limit.

    Args:
        tracks: tracks of the moving bodies, e.g. of a hand and of the tool that it holds.
        others: bodies at rest with their poses.
        floor: whether the floor counts as a body.
        limit: largest distance of interest [m].
        precision: largest difference between the result and the least distance [m].
    """
    best: Clearance | None = None
    for track in tracks:
        for body, pose in others:
            if track.bound_distance(body, pose) > (limit if best is None else min(limit, best.distance)):
                continue
            best = _improve(best, track, body.name, _distance_from(track.body, body, pose), limit, precision)
        if floor:
            best = _improve(best, track, FLOOR, _height_of(track.body), limit, precision)
    return best


_Distance = Callable[[Pose, float], float]
"""``distance(pose, limit)`` returns the distance at a pose [m]. Above the limit, a lower bound suffices."""


def _distance_from(moving: Body, other: Body, there: Pose) -> _Distance:
    def distance(at: Pose, limit: float) -> float:
        bound = bound_distance(moving, at, other, there)
        return bound if bound > limit else find_nearest(moving, at, other, there).distance

    return distance


def _height_of(moving: Body) -> _Distance:
    return lambda at, limit: moving.height(at)


def _improve(
    best: Clearance | None, track: Track, other: str, distance: _Distance, limit: float, precision: float
) -> Clearance | None:
    """Return the smaller one of the best distance so far and the least distance from another body."""
    most = limit if best is None else min(limit, best.distance)
    found = _bisect(track, distance, most, precision)
    return best if found is None else Clearance(found[0], found[1], track.body.name, other)


def _bisect(track: Track, distance: _Distance, most: float, precision: float) -> tuple[float, float] | None:
    """Return the least distance [m] that is not above `most`, and its phase. None if no distance is below `most`."""
    phases = [float(index) for index in range(len(track.positions))]
    # Distances above this value at both ends exclude the interval, so a lower bound suffices there.
    far = most + max((track.bound(begin, begin + 1.0) for begin in phases[:-1]), default=0.0)
    known = [distance(track.at(phase), far) for phase in phases]
    best = min(zip(known, phases, strict=True))
    waiting = [
        _interval(track, begin, end, first, last)
        for begin, end, first, last in zip(phases, phases[1:], known, known[1:], strict=False)
    ]
    heapq.heapify(waiting)
    while waiting:
        bound, begin, end, first, last = heapq.heappop(waiting)
        if bound >= min(best[0], most) - precision:
            break
        middle = (begin + end) / 2.0
        here = distance(track.at(middle), far)
        best = min(best, (here, middle))
        heapq.heappush(waiting, _interval(track, begin, middle, first, here))
        heapq.heappush(waiting, _interval(track, middle, end, here, last))
    return best if best[0] < most else None


def _interval(
    track: Track, begin: float, end: float, first: float, last: float
) -> tuple[float, float, float, float, float]:
    """Return the least possible distance on an interval, with the interval and the distances at its ends."""
    return (first + last - track.bound(begin, end)) / 2.0, begin, end, first, last


def _turn_between(one: FloatArray, other: FloatArray, axial: bool) -> float:
    """Return the angle of the turn between two orientations or, if `axial`, the path of the z axis on a unit sphere."""
    angle = 2.0 * acos(min(abs(float(one @ other)), 1.0))
    if not axial or angle < _TINY:
        return angle
    x, y, z, _ = quaternion_multiply(quaternion_conjugate(one), other)
    return angle * hypot(x, y) / hypot(x, y, z)


def _between(one: FloatArray, other: FloatArray, share: float) -> FloatArray:
    """Return the orientation after a share of the shortest turn at constant speed."""
    cosine = float(one @ other)
    other, cosine = (-other, -cosine) if cosine < 0 else (other, cosine)
    half = acos(min(cosine, 1.0))
    if half < 1e-6:
        mixed = (1.0 - share) * one + share * other
        return np.asarray(mixed / np.linalg.norm(mixed))
    return np.asarray((sin((1.0 - share) * half) * one + sin(share * half) * other) / sin(half))
