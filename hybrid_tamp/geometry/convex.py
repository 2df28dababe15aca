"""Convex bodies in the world: their lowest points and their overlaps.

All computations use support points, the furthest points of a body along a direction, so that they treat all pairs of
shapes alike (Gilbert, Johnson and Keerthi 1988, "A fast procedure for computing the distance between complex objects
in three-dimensional space").
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
"""Largest overlap of bodies that only touch [m]: written poses are rounded."""
_MOST_STEPS = 64


@dataclass(frozen=True, eq=False)
class ConvexBody:
    """A box, cylinder, sphere or convex hull at a pose.

    Attributes:
        half: half extents ``(3,)`` [m] of a core along the body's axes; x and y are zero for a cylinder.
        disc: radius [m] of a disc perpendicular to the body's z axis that is swept over the core.
        ball: radius [m] of a ball that is swept over the core.
        position: of the centre ``(3,)`` [m].
        axes: the body's axes in the world as rows ``(3, 3)``.
        points: corners of a hull ``(n, 3)`` [m] in its frame, instead of half, disc and ball; or None.
    """

    half: FloatArray
    disc: float
    ball: float
    position: FloatArray
    axes: FloatArray
    points: FloatArray | None = None

    @property
    def reach(self) -> float:
        """Radius of a ball about the centre that contains the body [m]."""
        if self.points is not None:
            return float(np.linalg.norm(self.points, axis=1).max())
        half = self.half + np.array([self.disc, 0.0, 0.0])
        return float(np.linalg.norm(half)) + self.ball

    def support(self, direction: FloatArray) -> FloatArray:
        """Return the furthest point ``(3,)`` [m] of the body along a direction ``(3,)`` of non-zero length."""
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
        """Return the body without its outermost layer of this depth [m]; a thin body keeps its middle."""
        if self.points is not None:
            middle = (self.points.min(axis=0) + self.points.max(axis=0)) / 2.0
            kept = 1.0 - depth / np.maximum(np.ptp(self.points, axis=0) / 2.0, depth)
            return replace(self, points=middle + (self.points - middle) * kept)
        half = np.where(self.half > 0, np.maximum(self.half - depth, 0.0), 0.0)
        disc, ball = max(self.disc - depth, 0.0), max(self.ball - depth, 0.0)
        return ConvexBody(half, disc, ball, self.position, self.axes)


Body = Sequence[ConvexBody]
"""The convex solids of a body; several for a compound or a mesh."""


def placed(shape: Shape, position: FloatArray, orientation: FloatArray) -> Body:
    """Return the body of a shape at a position ``(3,)`` [m] and an orientation, a unit quaternion ``(4,)``."""
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
    """Return a hull about the middle of its bounding box, so that its position is inside."""
    middle = (part.vertices.min(axis=0) + part.vertices.max(axis=0)) / 2.0
    return ConvexBody(np.zeros(3), 0.0, 0.0, position + middle @ axes, axes, part.vertices - middle)


def _core(shape: Solid) -> tuple[FloatArray, float, float]:
    if isinstance(shape, Box):
        return np.asarray(shape.half_extents, dtype=float), 0.0, 0.0
    if isinstance(shape, Cylinder):
        return np.array([0.0, 0.0, shape.length / 2]), shape.radius, 0.0
    return np.zeros(3), 0.0, shape.radius


def lowest_height(body: Body) -> float:
    """Return the height of the body's lowest point [m]."""
    return min(float(part.support(np.array([0.0, 0.0, -1.0]))[2]) for part in body)


def overlap(one: Body, other: Body) -> FloatArray | None:
    """Return a short displacement ``(3,)`` [m] that moves `other` clear of `one`; None if they only touch or are apart.

    It is the shortest one along the solids' axes, edges and the lines between their centres, except those that lead
    down, where there may be a floor. It separates the convex hulls of compounds.
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
    """Return a short displacement that moves one convex body clear of another, or None."""
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
    """Yield each pair of bodies that share space: (earlier, later, displacement that moves the later one clear).

    Each body is the later one of at most one pair, because nobody reads all pairs of a heap.

    Args:
        bodies: all bodies.
        pass_through: says whether a pair (earlier, later) may share space.
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
    """Return the lower and upper corners ``(2, 3)`` [m] of the axis-aligned bounding box of a body."""
    corners = np.array(
        [[[part.support(sign * axis)[i] for i, axis in enumerate(np.eye(3))] for part in body] for sign in (-1.0, 1.0)]
    )
    return np.array([corners[0].min(axis=0), corners[1].max(axis=0)])


def _directions(one: ConvexBody, other: ConvexBody) -> Iterator[FloatArray]:
    """Yield unit vectors along which the bodies may be apart; for two boxes they suffice."""
    between = other.position - one.position
    crossed = [np.cross(mine, theirs) for mine in one.axes for theirs in other.axes]
    # From the axis of each to the other's centre: the shortest way out of a body that is round about its axis.
    radial = [between - axis * float(between @ axis) for axis in (one.axes[2], other.axes[2])]
    for direction in (between, *one.axes, *other.axes, *radial, *crossed):
        length = float(np.linalg.norm(direction))
        if length > 1e-9:
            yield direction / length
            yield -direction / length


def _share_a_point(one: ConvexBody, other: ConvexBody) -> bool:
    """Say whether the bodies meet, that is, whether the set of differences of their points contains zero.

    Each step adds the difference furthest towards zero and keeps the corners of the face of the simplex that is nearest
    to zero. Bodies that are undecided after `_MOST_STEPS` steps merely touch.
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
    """Return the point of a simplex nearest to zero, with the fewest corners whose hull contains it."""
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
