"""Distances between convex bodies, and solids of a body that lie apart from the other solids.

The distance is computed from support points (Gilbert, Johnson and Keerthi 1988, "A fast procedure for computing the
distance between complex objects in three-dimensional space").
"""

from dataclasses import dataclass
from itertools import combinations
from typing import Protocol

import numpy as np

from hybrid_tamp.geometry.convex import Body, ConvexBody
from hybrid_tamp.geometry.overlaps import nearest_to_zero
from hybrid_tamp.motion.arrays import FloatArray

MOST_APART = 1e-3
"""Largest distance of solids that touch, relative to the longest edge of the body's bounding box."""
_MOST_STEPS = 200
_PRECISION = 1e-9
"""Largest error of a distance, relative to the size of the bodies."""


@dataclass(frozen=True)
class Gap:
    """A distance between two solids of a body.

    Attributes:
        one: index of the first solid.
        other: index of the second solid.
        width: distance between both solids [m].
    """

    one: int
    other: int
    width: float


class Convex(Protocol):
    """A convex body with support points. See `ConvexBody` for the members."""

    @property
    def position(self) -> FloatArray: ...  # noqa: D102 described in ConvexBody

    @property
    def reach(self) -> float: ...  # noqa: D102 described in ConvexBody

    def support(self, direction: FloatArray) -> FloatArray: ...  # noqa: D102 described in ConvexBody


@dataclass(frozen=True, eq=False)
class Swept:
    """The space that a convex body sweeps while it falls.

    Attributes:
        body: the body before the fall.
        fall: height of the fall [m].
    """

    body: ConvexBody
    fall: float

    @property
    def position(self) -> FloatArray:
        """Position of the body before the fall [m], shape ``(3,)``."""
        return self.body.position

    @property
    def reach(self) -> float:
        """Radius of a ball around `position` that contains the space [m]."""
        return self.body.reach + self.fall

    def support(self, direction: FloatArray) -> FloatArray:
        """Return the furthest point of the space along a non-zero vector [m], shape ``(3,)``."""
        down = np.array([0.0, 0.0, self.fall if direction[2] < 0 else 0.0])
        return np.asarray(self.body.support(direction) - down)


def distance_between(one: Convex, other: Convex) -> float:
    """Return the distance between two convex bodies [m], which is zero if they have a common point."""

    def furthest(direction: FloatArray) -> FloatArray:
        return one.support(direction) - other.support(-direction)

    size = one.reach + other.reach
    start = one.position - other.position
    corners = [furthest(-start if start.any() else np.array([1.0, 0.0, 0.0]))]
    for _ in range(_MOST_STEPS):
        corners, nearest = nearest_to_zero(corners)
        length = float(np.linalg.norm(nearest))
        if length < _PRECISION * size:
            return 0.0
        corner = furthest(-nearest)
        # No point of the difference of both bodies is nearer to zero than its furthest point towards zero.
        if length - float(corner @ nearest) / length < _PRECISION * size:
            return length
        corners.append(corner)
    return length


def distance_to_point(body: ConvexBody, point: FloatArray) -> float:
    """Return the distance [m] of a point ``(3,)`` from a convex body, which is zero inside the body."""
    return distance_between(body, ConvexBody(np.zeros(3), 0.0, 0.0, point, np.eye(3)))


def find_gap(body: Body, tolerance: float) -> Gap | None:
    """Return the narrowest gap around the first solids of a body, or None if all solids are connected.

    Two solids are connected if their distance is at most the tolerance, directly or by way of other solids.

    Args:
        body: convex solids.
        tolerance: largest distance of connected solids [m].
    """
    corners = np.array([_box(part) for part in body])
    groups = list(range(len(body)))
    for one, other in _touching_corners(body, tolerance):
        _merge(groups, one, other)
    apart = _distances_of_boxes(corners)
    for one, other in combinations(range(len(body)), 2):
        if groups[one] == groups[other] or apart[one, other] > tolerance:
            continue
        if distance_between(body[one], body[other]) <= tolerance:
            _merge(groups, one, other)
    pairs = [
        (i, j) for i, j in combinations(range(len(body)), 2) if (groups[i] == groups[0]) != (groups[j] == groups[0])
    ]
    best: Gap | None = None
    for one, other in sorted(pairs, key=lambda pair: float(apart[pair])):
        if best is not None and apart[one, other] >= best.width:
            break
        width = distance_between(body[one], body[other])
        if best is None or width < best.width:
            best = Gap(one, other, width)
    return best


def _merge(groups: list[int], one: int, other: int) -> None:
    kept, given = groups[one], groups[other]
    groups[:] = [kept if group == given else group for group in groups]


def _touching_corners(body: Body, tolerance: float) -> list[tuple[int, int]]:
    """Return pairs of hulls with a common corner. The distance of these hulls need not be computed."""
    seen: dict[tuple[int, ...], int] = {}
    found = []
    for number, part in enumerate(body):
        if part.points is not None:
            for key in map(tuple, np.round((part.position + part.points @ part.axes) / tolerance).astype(int).tolist()):
                if (first := seen.setdefault(key, number)) != number:
                    found.append((first, number))
    return list(dict.fromkeys(found))


def _box(part: ConvexBody) -> FloatArray:
    return np.array([-part.extents(-np.eye(3)), part.extents(np.eye(3))])


def _distances_of_boxes(corners: FloatArray) -> FloatArray:
    """Return the distances ``(n, n)`` [m] between bounding boxes ``(n, 2, 3)``, which are lower bounds of distances."""
    lower, upper = corners[:, 0], corners[:, 1]
    between = np.maximum(lower[:, None] - upper[None], lower[None] - upper[:, None])
    return np.asarray(np.linalg.norm(np.maximum(between, 0.0), axis=-1))
