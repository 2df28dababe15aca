"""Polylines with rounded corners, along which a body moves from rest to rest."""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.profile import Profile

_ROUNDING = 0.05
"""Largest length of a leg that a rounded corner replaces [m]."""
CORNER_SAMPLES = 8
"""Number of points that replace an inner corner."""
_TURNING = 0.3
"""Length [m] that counts for each radian of a turn. A body moves slowly while it turns."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve along which a body moves from rest to rest.

    Attributes:
        points: densely sampled points of the curve ``(..., p, 3)`` [m].
        arcs: length from the start to each point ``(..., p)`` [m]. A turn of the body adds to the length.
        paces: ratio of the distance between two points to the length between them ``(..., p - 1)``, from 0 to 1.
        turning: lengths at which the body begins and ends to turn ``(..., 2)`` [m].
    """

    points: FloatArray
    arcs: FloatArray
    paces: FloatArray
    turning: FloatArray

    @classmethod
    def through(cls, corners: FloatArray) -> "Curve":
        """Return the curve along polylines ``(..., c, 3)`` [m] without turns. Inner corners are rounded."""
        points = round_corners(corners)
        steps = np.linalg.norm(np.diff(points, axis=-2), axis=-1)
        return cls(points, _arcs(steps), np.ones_like(steps), np.zeros((*steps.shape[:-1], 2)))

    def turning_within(self, angle: FloatArray, corners: FloatArray | int) -> "Curve":
        """Return the same curve for a body that turns between the second corner and the last but one.

        Args:
            angle: angle of the turn ``(...)`` [rad].
            corners: number of corners of the polyline ``(...)``, at least 4. The last corner may be repeated further.
        """
        steps, index = np.diff(self.arcs, axis=-1), np.arange(self.arcs.shape[-1] - 1)
        # The samples from the end of the rounded second corner to the start of the rounded last corner but one.
        last = 1 + CORNER_SAMPLES * (np.asarray(corners)[..., None] - 3)
        within = (index >= CORNER_SAMPLES) & (index < last) & (np.asarray(angle)[..., None] > 0.0)
        # A body that does not move between the two corners turns on the spot.
        moved = np.where(within, steps + 1e-6, 0.0)
        share = moved / np.maximum(moved.sum(axis=-1, keepdims=True), 1e-6)
        longer = steps + _TURNING * np.asarray(angle)[..., None] * share
        begin = np.where(index < CORNER_SAMPLES, steps, 0.0).sum(axis=-1)
        turning = np.stack([begin, begin + np.where(within, longer, 0.0).sum(axis=-1)], axis=-1)
        paces = np.where(within, steps / np.maximum(longer, 1e-12), 1.0)
        return Curve(self.points, _arcs(longer), paces, turning)

    @property
    def length(self) -> FloatArray:
        """Length of the curve ``(...)`` [m]."""
        return np.asarray(self.arcs[..., -1])

    def at(self, elapsed: FloatArray, duration: FloatArray, profile: Profile) -> tuple[FloatArray, FloatArray]:
        """Return the position [m] and velocity [m/s], each ``(..., 3)``, for a movement with a speed profile."""
        travelled, speed = profile.advance(elapsed, duration, self.length)
        index = np.clip(np.sum(self.arcs <= travelled[..., None], axis=-1), 1, self.arcs.shape[-1] - 1)
        # The open grid of indices lets each member of the batch read its own curve.
        members = np.indices(self.arcs.shape[:-1], sparse=True)
        before, after = (*members, index - 1), (*members, index)
        low, high, start = self.points[before], self.points[after], self.arcs[before]
        along = high - low
        span = np.linalg.norm(along, axis=-1)
        direction = along / np.maximum(span, 1e-12)[..., None]
        pace = self.paces[before]
        return low + direction * (pace * (travelled - start))[..., None], direction * (pace * speed)[..., None]

    def turned(self, elapsed: FloatArray, duration: FloatArray, profile: Profile) -> tuple[FloatArray, FloatArray]:
        """Return the share of the turn that the body has made, and the rate of this share [1/s], each ``(...)``."""
        travelled, speed = profile.advance(elapsed, duration, self.length)
        begin, end = self.turning[..., 0], self.turning[..., 1]
        span = np.maximum(end - begin, 1e-9)
        part = np.clip((travelled - begin) / span, 0.0, 1.0)
        # The cubic has zero slope at both ends, so the angular velocity does not jump.
        return part**2 * (3.0 - 2.0 * part), 6.0 * part * (1.0 - part) * speed / span


def round_corners(corners: FloatArray) -> FloatArray:
    """Replace each inner corner of polylines ``(..., c, 3)`` with a short parabola. Return points ``(..., p, 3)``."""
    pieces = [corners[..., :1, :]]
    part = np.linspace(0.0, 1.0, CORNER_SAMPLES)[:, None]
    for index in range(1, corners.shape[-2] - 1):
        corner = corners[..., index : index + 1, :]
        into = _shortened(corners[..., index - 1 : index, :] - corner)
        out = _shortened(corners[..., index + 1 : index + 2, :] - corner)
        pieces.append(corner + into * (1.0 - part) ** 2 + out * part**2)
    return np.concatenate([*pieces, corners[..., -1:, :]], axis=-2)


def _arcs(steps: FloatArray) -> FloatArray:
    """Return the lengths ``(..., p)`` [m] from the start of a curve to its points, for the lengths of its parts."""
    return np.concatenate([np.zeros((*steps.shape[:-1], 1)), np.cumsum(steps, axis=-1)], axis=-1)


def _shortened(leg: FloatArray) -> FloatArray:
    """Return the part of a leg that a rounded corner replaces, which is at most half of the leg."""
    length = np.linalg.norm(leg, axis=-1, keepdims=True)
    return np.asarray(leg * np.minimum(0.5, _ROUNDING / np.maximum(length, 1e-9)))
