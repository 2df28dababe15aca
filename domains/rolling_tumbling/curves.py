"""Routes of hands around a box, and the curves along them."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from hybrid_tamp.authoring import FloatArray, State
from hybrid_tamp.skills import Curve

_LONGEST = 7
"""Number of corners of the longest route around a box. All curves have at least as many corners."""


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
    curve = Curve.through(np.array([_padded(route.corners, count) for route in routes]))
    angles = np.array([route.angle for route in routes])
    if angles.any():
        curve = curve.turning_within(angles, np.array([len(route.corners) for route in routes]))
    batch = start.values.shape[:-1]
    shapes = ((-1, 3), (-1,), (-1,), (2,))
    arrays = (curve.points, curve.arcs, curve.paces, curve.turning)
    return Curve(*(array.reshape(*batch, *shape) for array, shape in zip(arrays, shapes, strict=True)))


def _padded(corners: list[FloatArray], count: int) -> FloatArray:
    """Repeat the last corner of a polyline until it has `count` corners."""
    return np.array(corners + [corners[-1]] * (count - len(corners)))
