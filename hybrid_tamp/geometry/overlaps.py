"""Overlaps of convex bodies in the world.

All computations use support points. So the same algorithm works for all pairs of shapes (Gilbert, Johnson and Keerthi
1988, "A fast procedure for computing the distance between complex objects in three-dimensional space").
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations, product

import numpy as np

from hybrid_tamp.geometry.convex import CONTACT, Body, ConvexBody
from hybrid_tamp.motion.arrays import FloatArray

_MOST_STEPS = 64
_ROUNDING = 1e-12
"""Largest difference of equal depths [m]."""
_DIGITS = 9
"""Number of decimal places of equal axes."""
_MOST_PAIRS = 64
"""Largest number of pairs of solids whose directions are candidates for the displacement that ends an overlap."""


def overlap(one: Body, other: Body) -> FloatArray | None:
    """Return a displacement of `other` that ends the overlap with `one` [m], shape ``(3,)``, or None without overlap.

    The candidate directions are the axes of the solids, the lines between the centres, and the cross products of axes.
    Downward directions are excluded, because the floor may be there. The result is the shortest separating displacement
    along a candidate direction. It separates compounds by their convex hulls, so it may be longer than necessary.
    Bodies that only touch do not overlap.

    To save time, one computation for all pairs excludes most pairs, and at most `_MOST_PAIRS` pairs give directions.
    """
    near = [(one[i], other[j]) for i, j in _find_near(one, other)]
    if len(one) * len(other) == 1:
        return _overlap(*near[0]) if near else None
    if all(_overlap(mine, theirs) is None for mine, theirs in near):
        return None
    pairs = list(product(one, other)) if len(one) * len(other) <= _MOST_PAIRS else near[:_MOST_PAIRS]
    directions = np.array([d for mine, theirs in pairs for d in _directions(mine, theirs) if d[2] > -0.5])
    highest = np.max([mine.extents(directions) for mine in one], axis=0)
    lowest = -np.max([theirs.extents(-directions) for theirs in other], axis=0)
    depths = highest - lowest
    # Depths that differ only by rounding are equal. The first of them wins.
    shortest = int(np.argmax(depths <= depths.min() + _ROUNDING))
    return np.asarray(directions[shortest] * depths[shortest])


def _find_near(one: Body, other: Body) -> Iterator[tuple[int, int]]:
    """Yield the index pairs of solids that no axis of any solid separates. All other pairs do not overlap."""
    axes = np.concatenate([part.axes for part in (*one, *other)])
    axes = axes[np.sort(np.unique(axes.round(_DIGITS), axis=0, return_index=True)[1])]
    apart = np.zeros((len(one), len(other)), dtype=bool)
    for directions in (axes, -axes):
        highest = np.array([part.extents(directions) for part in one])  # (p, m)
        lowest = -np.array([part.extents(-directions) for part in other])  # (q, m)
        for high, low in zip(highest.T, lowest.T, strict=True):
            apart |= high[:, None] - low[None, :] <= CONTACT
    yield from zip(*map(np.ndarray.tolist, np.nonzero(~apart)), strict=True)


def _overlap(one: ConvexBody, other: ConvexBody) -> FloatArray | None:
    """Return a displacement of a convex body `other` that ends its overlap with `one` [m], or None without overlap."""
    best: FloatArray | None = None
    least = np.inf
    for direction in _directions(one, other):
        way = float((one.support(direction) - other.support(-direction)) @ direction)
        if way <= CONTACT:
            return None
        if way < least and direction[2] > -0.5:
            least, best = way, direction * way
    inner, outer = one.shrunk(CONTACT / 2), other.shrunk(CONTACT / 2)
    return best if _share_a_point(inner, outer) else None


def overlaps(
    bodies: Sequence[Body], pass_through: Callable[[int, int], bool] = lambda earlier, later: False
) -> Iterator[tuple[int, int, FloatArray]]:
    """Yield the pairs of overlapping bodies as triples of (first index, second index, displacement of the second body).

    Each body is reported at most once as the second body, with the smallest first index that is less than its own.

    Args:
        bodies: bodies to check.
        pass_through: function that returns whether the bodies with two given indices are allowed to overlap.
    """
    corners = np.array([_corners(body) for body in bodies]).reshape(-1, 2, 3)
    for later, body in enumerate(bodies):
        lower, upper = corners[later]
        near = np.all((corners[:later, 0] < upper) & (corners[:later, 1] > lower), axis=-1)
        suspects = (earlier for earlier in map(int, np.flatnonzero(near)) if not pass_through(earlier, later))
        found = ((earlier, overlap(bodies[earlier], body)) for earlier in suspects)
        first = next(((earlier, way) for earlier, way in found if way is not None), None)
        if first is not None:
            yield first[0], later, first[1]


def _corners(body: Body) -> FloatArray:
    """Return the lower and the upper corner of a body's axis-aligned bounding box [m], shape ``(2, 3)``."""
    corners = np.array(
        [[[part.support(sign * axis)[i] for i, axis in enumerate(np.eye(3))] for part in body] for sign in (-1.0, 1.0)]
    )
    return np.array([corners[0].min(axis=0), corners[1].max(axis=0)])


def _directions(one: ConvexBody, other: ConvexBody) -> Iterator[FloatArray]:
    """Yield unit vectors that are candidates for separating directions. For two boxes, the candidates are complete."""
    between = other.position - one.position
    crossed = [np.cross(mine, theirs) for mine in one.axes for theirs in other.axes]
    # The direction from the axis of a body to the centre of the other body is the shortest way out of a round body.
    radial = [between - axis * float(between @ axis) for axis in (one.axes[2], other.axes[2])]
    for direction in (between, *one.axes, *other.axes, *radial, *crossed):
        length = float(np.linalg.norm(direction))
        if length > 1e-9:
            yield direction / length
            yield -direction / length


def _share_a_point(one: ConvexBody, other: ConvexBody) -> bool:
    """Return whether the bodies have a common point.

    The bodies have a common point if the set of differences between their points contains zero. Each step adds the
    difference that is furthest towards zero to a simplex, and keeps the face of the simplex that is nearest to zero. If
    the result is undecided after `_MOST_STEPS` steps, the bodies are assumed only to touch, and the result is False.
    """

    def furthest(direction: FloatArray) -> FloatArray:
        return one.support(direction) - other.support(-direction)

    size = one.reach + other.reach
    corners = [furthest(np.array([1.0, 0.0, 0.0]))]
    for _ in range(_MOST_STEPS):
        corners, nearest = nearest_to_zero(corners)
        if len(corners) == 4 or float(nearest @ nearest) < (1e-9 * size) ** 2:
            return True
        corner = furthest(-nearest)
        if float(corner @ nearest) > 0:
            # The plane through zero perpendicular to `nearest` separates the bodies.
            return False
        corners.append(corner)
    return False


def nearest_to_zero(corners: list[FloatArray]) -> tuple[list[FloatArray], FloatArray]:
    """Return the corners of the smallest face that contains the simplex's nearest point to zero, and that point."""
    best: tuple[list[FloatArray], FloatArray] = (corners[:1], corners[0])
    for count in range(1, len(corners) + 1):
        for chosen in combinations(corners, count):
            first = chosen[0]
            edges = np.array([corner - first for corner in chosen[1:]]).reshape(-1, 3)
            weights = np.linalg.lstsq(edges.T, -first, rcond=None)[0] if count > 1 else np.zeros(0)
            if float(weights.sum()) > 1.0 or np.any(weights < 0.0):
                continue
            point = first + weights @ edges
            if float(point @ point) < float(best[1] @ best[1]):
                best = (list(chosen), point)
    return best
