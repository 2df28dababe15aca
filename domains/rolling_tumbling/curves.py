"""Rounded polylines along which hands move from rest to rest."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hybrid_tamp.authoring import FloatArray, Profile, State
from hybrid_tamp.skills import advance

_ROUNDING = 0.05
_SAMPLES = 8
_LONGEST = 7
"""Number of corners of the longest route around a box. All curves have at least as many corners."""
_TURNING = 0.3
"""Length of curve [m] that counts for each radian of the hand's turn. The hand moves slowly while it turns."""


class Route(NamedTuple):
    """A route of a hand.

    Attributes:
        corners: corners of the route, each ``(3,)`` [m], at least 4.
        angle: angle [rad] by which the hand turns between the second corner and the last but one.
    """

    corners: list[FloatArray]
    angle: float = 0.0

    def along(self, path: FloatArray) -> "Route":
        """Return the route from start to end along the inner corners of a path ``(c, 3)`` [m]."""
        start, end = self.corners[0], self.corners[-1]
        inner = [*path[1:-1]]
        while len(inner) < 2:
            inner.append(((inner[-1] if inner else start) + end) / 2.0)
        return Route([start, *inner, end], self.angle)


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve along which a hand moves from rest to rest.

    Attributes:
        points: densely sampled points of the curve ``(..., p, 3)`` [m].
        arcs: length from the start to each point ``(..., p)`` [m]. A turn of the hand adds to the length.
        paces: ratio of the distance between two points to the length between them ``(..., p - 1)``, from 0 to 1.
        turning: lengths at which the hand begins and ends to turn ``(..., 2)`` [m].
    """

    points: FloatArray
    arcs: FloatArray
    paces: FloatArray
    turning: FloatArray

    @property
    def length(self) -> FloatArray:
        """Length of the curve ``(...)`` [m]."""
        return np.asarray(self.arcs[..., -1])

    def at(self, elapsed: FloatArray, duration: FloatArray, profile: Profile) -> tuple[FloatArray, FloatArray]:
        """Return the hand's position [m] and velocity [m/s], each ``(..., 3)``, for a movement with a speed profile."""
        travelled, speed = advance(profile, elapsed, duration, self.length)
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
        """Return the share of the turn that the hand has made, and the rate of this share [1/s], each ``(...)``."""
        travelled, speed = advance(profile, elapsed, duration, self.length)
        begin, end = self.turning[..., 0], self.turning[..., 1]
        span = np.maximum(end - begin, 1e-9)
        part = np.clip((travelled - begin) / span, 0.0, 1.0)
        # The cubic has zero slope at both ends, so the angular velocity does not jump.
        return part**2 * (3.0 - 2.0 * part), 6.0 * part * (1.0 - part) * speed / span


def curve_through(start: State, make: Callable[[State], Route]) -> Curve:
    """Return a curve with rounded corners for each state of a batch. ``make(state)`` returns the route."""
    rows = start.values.reshape(-1, start.values.shape[-1])
    routes = [make(State(start.layout, row)) for row in rows]
    count = max(_LONGEST, *(len(route.corners) for route in routes))
    points = _rounded(np.array([_padded(route.corners, count) for route in routes]))
    steps = np.linalg.norm(np.diff(points, axis=-2), axis=-1)
    paces, turning = np.ones_like(steps), np.zeros((len(rows), 2))
    for row, route in enumerate(routes):
        if route.angle > 0.0:
            # The samples from the end of the rounded second corner to the start of the rounded last corner but one.
            first, last = _SAMPLES, 1 + _SAMPLES * (len(route.corners) - 3)
            # A hand that does not move between the two corners turns on the spot.
            moved = steps[row, first:last].copy()
            share = (moved + 1e-6) / (moved + 1e-6).sum()
            before = float(steps[row, :first].sum())
            steps[row, first:last] += _TURNING * route.angle * share
            paces[row, first:last] = moved / steps[row, first:last]
            turning[row] = before, before + float(steps[row, first:last].sum())
    arcs = np.concatenate([np.zeros((len(rows), 1)), np.cumsum(steps, axis=-1)], axis=-1)
    batch = start.values.shape[:-1]
    shapes = ((-1, 3), (-1,), (-1,), (2,))
    return Curve(*(a.reshape(*batch, *shape) for a, shape in zip((points, arcs, paces, turning), shapes, strict=True)))


def _padded(corners: list[FloatArray], count: int) -> FloatArray:
    """Repeat the last corner of a polyline until it has `count` corners."""
    return np.array(corners + [corners[-1]] * (count - len(corners)))


def _rounded(corners: FloatArray) -> FloatArray:
    """Replace each inner corner of polylines ``(n, c, 3)`` with a short parabola. Return points ``(n, p, 3)``."""
    pieces = [corners[:, :1]]
    part = np.linspace(0.0, 1.0, _SAMPLES)[:, None]
    for index in range(1, corners.shape[1] - 1):
        corner = corners[:, index : index + 1]
        into = _shortened(corners[:, index - 1 : index] - corner)
        out = _shortened(corners[:, index + 1 : index + 2] - corner)
        pieces.append(corner + into * (1.0 - part) ** 2 + out * part**2)
    return np.concatenate([*pieces, corners[:, -1:]], axis=1)


def _shortened(leg: FloatArray) -> FloatArray:
    """Return the part of a leg that a rounded corner replaces, which is at most half of the leg."""
    length = np.linalg.norm(leg, axis=-1, keepdims=True)
    return np.asarray(leg * np.minimum(0.5, _ROUNDING / np.maximum(length, 1e-9)))
