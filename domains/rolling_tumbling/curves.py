"""Routes of hands around a box, and the curves along them."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from hybrid_tamp.authoring import FloatArray, State
from hybrid_tamp.skills import CORNER_SAMPLES, Curve, round_corners

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


def curve_through(start: State, make: Callable[[State], Route]) -> Curve:
    """Return a curve with rounded corners for each state of a batch. ``make(state)`` returns the route."""
    rows = start.values.reshape(-1, start.values.shape[-1])
    routes = [make(State(start.layout, row)) for row in rows]
    count = max(_LONGEST, *(len(route.corners) for route in routes))
    points = round_corners(np.array([_padded(route.corners, count) for route in routes]))
    steps = np.linalg.norm(np.diff(points, axis=-2), axis=-1)
    paces, turning = np.ones_like(steps), np.zeros((len(rows), 2))
    for row, route in enumerate(routes):
        if route.angle > 0.0:
            # The samples from the end of the rounded second corner to the start of the rounded last corner but one.
            first, last = CORNER_SAMPLES, 1 + CORNER_SAMPLES * (len(route.corners) - 3)
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
