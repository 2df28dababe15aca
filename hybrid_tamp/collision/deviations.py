"""How far the poses of a body are from the track that the body should follow."""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.collision.sweeps import Track
from hybrid_tamp.motion.arrays import BoolArray, FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, quaternion_multiply

_STEP = 1e-3
"""Longest path of a point of the body between two compared poses of the track [m]."""
_MOST = 64
"""Largest number of compared poses between two poses of the track."""


@dataclass(frozen=True, eq=False)
class Timing:
    """Times of the poses of two tracks.

    Attributes:
        found: times of the poses that are compared [s], shape ``(n,)``.
        wanted: times of the poses of the other track [s], shape ``(k,)``. The body waits at its last pose.
        skew: largest difference between the times of two compared poses [s].
    """

    found: FloatArray
    wanted: FloatArray
    skew: float

    def is_apart(self, phases: FloatArray) -> BoolArray:
        """Return the pairs of poses with different times, shape ``(n, p)``, for phases ``(p,)`` of the other track."""
        reached = np.interp(phases, range(len(self.wanted)), self.wanted)
        waited = np.minimum(self.found, self.wanted[-1])
        return np.asarray(np.abs(waited[:, None] - reached[None]) > self.skew)


def find_deviation(found: Track, wanted: Track, timing: Timing | None = None) -> float:
    """Return the largest distance of a point of a body from its place at the nearest pose of another track [m].

    The result is too large by at most half of `_STEP`, unless the poses of the track are far apart.

    Args:
        found: poses of the body, which are compared one by one.
        wanted: track of the same body.
        timing: times of the poses. If None, a pose is compared with the poses at all times.
    """
    phases = np.concatenate([[0.0], *(_divide(wanted, index) for index in range(len(wanted.positions) - 1))])
    poses = [wanted.at(float(phase)) for phase in phases]
    positions, orientations = np.array([p.position for p in poses]), np.array([p.orientation for p in poses])
    apart = np.linalg.norm(found.positions[:, None] - positions[None], axis=2)
    between = quaternion_multiply(quaternion_conjugate(orientations)[None], found.orientations[:, None])
    deviations = apart + found.body.reach * _angles(between, axial=found.body.axial)
    if timing is not None:
        deviations = np.where(timing.is_apart(phases), np.inf, deviations)
    return float(deviations.min(axis=1).max())


def _divide(track: Track, index: int) -> FloatArray:
    """Return the phases from a pose of a track, which is left out, to the next pose."""
    count = min(int(np.ceil(track.bound(index, index + 1.0) / _STEP)) or 1, _MOST)
    return index + np.arange(1, count + 1) / count


def _angles(turns: FloatArray, *, axial: bool) -> FloatArray:
    """Return the angles ``(...)`` [rad] of turns ``(..., 4)`` or, if `axial`, of the z axis of the body frame."""
    if axial:
        return np.asarray(2.0 * np.arcsin(np.minimum(np.hypot(turns[..., 0], turns[..., 1]), 1.0)))
    return np.asarray(2.0 * np.arcsin(np.minimum(np.linalg.norm(turns[..., :3], axis=-1), 1.0)))
