"""Lowest points and overlaps of convex bodies in the world.

All computations use support points. The support point of a body along a direction is its furthest point in this
direction. So one algorithm works for all pairs of shapes (Gilbert, Johnson and Keerthi 1988, "A fast procedure for
computing the distance between complex objects in three-dimensional space").
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np

from hybrid_tamp.geometry.meshes import Hull
from hybrid_tamp.geometry.shapes import Box, Cylinder, Shape, Solid, solids_of
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rpy, rotate

CONTACT = 1e-3
"""Largest overlap that is treated as contact [m]. Poses in task files are rounded, so touching bodies can overlap."""
_MOST_STEPS = 64


@dataclass(frozen=True, eq=False)
class ConvexBody:
    """A box, cylinder, sphere or convex hull at a pose.

    Attributes:
        half: half extents of the core along the body's axes [m], shape ``(3,)``. x and y are zero for a cylinder.
        disc: radius of the disc that is swept over the core [m]. The disc is perpendicular to the body's z axis.
        ball: radius of the ball that is swept over the core [m].
        position: position of the centre in the world frame [m], shape ``(3,)``.
        axes: axes of the body as unit vectors in the world frame, one per row, shape ``(3, 3)``.
        points: corners of a convex hull in the body frame [m], shape ``(n, 3)``. None for other shapes.
    """

    half: FloatArray
    disc: float
    ball: float
    position: FloatArray
    axes: FloatArray
    points: FloatArray | None = None

    @property
    def reach(self) -> float:
        """Radius of a ball that is centred at the body's centre and contains the body [m]."""
        if self.points is not None:
            return float(np.linalg.norm(self.points, axis=1).max())
        half = self.half + np.array([self.disc, 0.0, 0.0])
        return float(np.linalg.norm(half)) + self.ball

    def support(self, direction: FloatArray) -> FloatArray:
        """Return the furthest point of the body along a non-zero vector, in the world frame [m], shape ``(3,)``."""
        local = self.axes @ direction
        if self.points is not None:
            return np.asarray(self.position + self.points[np.argmax(self.points @ local)] @ self.axes)
        point = np.sign(local) * self.half
        across = float(np.hypot(local[0], local[1]))
        if self.disc and across > 0:
            point[:2] += local[:2] * (self.disc / across)
        offset = np.asarray(point @ self.axes)
        if self.ball:
            offset = offset + direction * (self.ball / float(np.linalg.norm(direction)))
        return self.position + offset

    def shrunk(self, depth: float) -> "ConvexBody":
        """Return the body without its outermost layer of thickness `depth` [m]. A thin body shrinks to its middle."""
        if self.points is not None:
            middle = (self.points.min(axis=0) + self.points.max(axis=0)) / 2.0
            kept = 1.0 - depth / np.maximum(np.ptp(self.points, axis=0) / 2.0, depth)
            return replace(self, points=middle + (self.points - middle) * kept)
        half = np.where(self.half > 0, np.maximum(self.half - depth, 0.0), 0.0)
        disc, ball = max(self.disc - depth, 0.0), max(self.ball - depth, 0.0)
        return ConvexBody(half, disc, ball, self.position, self.axes)


Body = Sequence[ConvexBody]
"""Convex solids of a body. A compound or a mesh can have several convex solids."""


def placed(shape: Shape, position: FloatArray, orientation: FloatArray) -> Body:
    """Return the body of a shape. The position [m] has shape ``(3,)`` and the unit quaternion has shape ``(4,)``."""
    solids = []
    for part in solids_of(shape):
        axes = rotate(orientation, rotate(quaternion_from_rpy(part.rpy), np.eye(3)))
        place = position + rotate(orientation, part.position)
        if isinstance(part, Hull):
            solids.append(_hull(part, place, axes))
        else:
            solids.append(ConvexBody(*_core(part), place, axes))
    return solids


def _hull(part: Hull, position: FloatArray, axes: FloatArray) -> ConvexBody:
    """Return a convex hull as a body whose centre is the centre of the hull's bounding box."""
    middle = (part.vertices.min(axis=0) + part.vertices.max(axis=0)) / 2.0
    return ConvexBody(np.zeros(3), 0.0, 0.0, position + middle @ axes, axes, part.vertices - middle)


def _core(shape: Solid) -> tuple[FloatArray, float, float]:
    if isinstance(shape, Box):
        return np.asarray(shape.half_extents, dtype=float), 0.0, 0.0
    if isinstance(shape, Cylinder):
        return np.array([0.0, 0.0, shape.length / 2]), shape.radius, 0.0
    return np.zeros(3), 0.0, shape.radius


def lowest_height(body: Body) -> float:
    """Return the height of the body's lowest point in the world frame [m]."""
    return min(float(part.support(np.array([0.0, 0.0, -1.0]))[2]) for part in body)


def overlap(one: Body, other: Body) -> FloatArray | None:
    """Return a displacement of `other` that separates the bodies [m], shape ``(3,)``. None if the bodies are separate.

    The candidate directions are the axes of the solids, the lines between the centres, and the cross products of axes.
    Downward directions are excluded, because the floor may be below. The displacement is the shortest along the
    candidates, and also separates the convex hulls of compounds. Bodies that only touch do not overlap.
    """
    pairs = list(product(one, other))
    ways = [way for mine, theirs in pairs if (way := _overlap(mine, theirs)) is not None]
    if not ways or len(pairs) == 1:
        return ways[0] if ways else None
    directions = [d for mine, theirs in pairs for d in _directions(mine, theirs) if d[2] > -0.5]
    depths = [
        max(float(mine.support(d) @ d) for mine in one) - min(float(theirs.support(-d) @ d) for theirs in other)
        for d in directions
    ]
    shortest = int(np.argmin(depths))
    return np.asarray(directions[shortest] * depths[shortest])


def _overlap(one: ConvexBody, other: ConvexBody) -> FloatArray | None:
    """Return a displacement of `other` that separates two convex bodies [m], or None if the bodies do not overlap."""
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
    """Yield a triple of (first index, second index, displacement of the second body) for each overlap of two bodies.

    The first index is less than the second index. Each second index is reported once, with the smallest first index.

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

    The bodies have a common point if the set of differences between their points contains zero. In each step, a simplex
    gains the difference that is furthest in the direction of zero, and is then reduced to its face nearest to zero. If
    `_MOST_STEPS` steps are not enough, the bodies only touch and the result is False.
    """

    def furthest(direction: FloatArray) -> FloatArray:
        return one.support(direction) - other.support(-direction)

    size = one.reach + other.reach
    corners = [furthest(np.array([1.0, 0.0, 0.0]))]
    for _ in range(_MOST_STEPS):
        corners, nearest = _nearest_to_zero(corners)
        if len(corners) == 4 or float(nearest @ nearest) < (1e-9 * size) ** 2:
            return True
        corner = furthest(-nearest)
        if float(corner @ nearest) > 0:
            # The plane through zero perpendicular to `nearest` separates the bodies.
            return False
        corners.append(corner)
    return False


def _nearest_to_zero(corners: list[FloatArray]) -> tuple[list[FloatArray], FloatArray]:
    """Return the simplex point nearest to zero, preceded by the corners of the smallest face with this point."""
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
