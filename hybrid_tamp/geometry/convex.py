"""Convex bodies in the world: how low they reach, and whether two of them share space.

Everything is asked through support points, the furthest ones of a body along a direction, so that each pair of shapes
is treated alike (Gilbert, Johnson and Keerthi 1988, "A fast procedure for computing the distance between complex
objects in three-dimensional space").
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
"""Bodies that overlap by at most this still only touch [m]: written poses are rounded."""
_MOST_STEPS = 64


@dataclass(frozen=True, eq=False)
class ConvexBody:
    """A box, cylinder, sphere or convex hull at a pose.

    Attributes:
        half: half extents ``(3,)`` [m] of a core along the body's axes; of a cylinder's, x and y are zero.
        disc: radius [m] of the disc across the body's z axis that is swept over the core.
        ball: radius [m] of the ball that is swept over the core.
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
        """Return the furthest point ``(3,)`` [m] of the body along a direction ``(3,)`` of any length but zero."""
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
"""The convex solids of a body; one unless it is a compound or a mesh."""


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
    """Return a hull about the middle of its box, so that its position is within it."""
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
    """Return a short way ``(3,)`` [m] by which `other` gets clear of `one`, or None if they only touch or are apart.

    The way is the shortest one along the parts' axes, edges and the lines between their centres, those aside that lead
    down, where there may be a floor; it does clear them. Of compounds it clears the convex hulls.
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
    """Return a short way by which one convex body gets clear of another, or None."""
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

    Of a heap each body is told once, with one other: all pairs of it would be as many as nobody reads.

    Args:
        bodies: all bodies.
        pass_through: which pairs, (earlier, later), may share space.
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
    """Return the lower and the upper corner ``(2, 3)`` [m] of the smallest upright box about a body."""
    corners = np.array(
        [[[part.support(sign * axis)[i] for i, axis in enumerate(np.eye(3))] for part in body] for sign in (-1.0, 1.0)]
    )
    return np.array([corners[0].min(axis=0), corners[1].max(axis=0)])


def _directions(one: ConvexBody, other: ConvexBody) -> Iterator[FloatArray]:
    """Unit vectors along which the bodies may be apart: for two boxes these are enough."""
    between = other.position - one.position
    crossed = [np.cross(mine, theirs) for mine in one.axes for theirs in other.axes]
    # From the axis of each to the other's centre: what is round about its axis is left fastest along it.
    radial = [between - axis * float(between @ axis) for axis in (one.axes[2], other.axes[2])]
    for direction in (between, *one.axes, *other.axes, *radial, *crossed):
        length = float(np.linalg.norm(direction))
        if length > 1e-9:
            yield direction / length
            yield -direction / length


def _share_a_point(one: ConvexBody, other: ConvexBody) -> bool:
    """Say whether the bodies meet: whether the set of differences of their points contains zero.

    Each step adds the difference furthest towards zero, and keeps the corners of that part of their hull which is
    nearest to zero. What is still undecided after many steps merely touches.
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
            # The plane through zero across `nearest` lies between the bodies.
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
