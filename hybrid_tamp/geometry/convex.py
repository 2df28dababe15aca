"""Convex bodies in the world, and their lowest points and support points.

The support point of a body along a direction is its furthest point in this direction.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hybrid_tamp.geometry.meshes import Hull
from hybrid_tamp.geometry.shapes import Box, Cylinder, Shape, Solid, solids_of
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rpy, rotate

CONTACT = 1e-3
"""Largest overlap that counts as mere contact [m]. Poses in task files are rounded, so touching bodies can overlap."""


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
        length = float(np.linalg.norm(direction))
        if self.ball and length > 0.0:  # The length of a tiny vector is rounded to zero.
            offset = offset + direction * (self.ball / length)
        return self.position + offset

    def supports(self, directions: FloatArray) -> FloatArray:
        """Return the furthest points of the body along m non-zero vectors, in the world frame [m]. Shape ``(m, 3)``."""
        local = directions @ self.axes.T
        if self.points is not None:
            return np.asarray(self.position + self.points[np.argmax(local @ self.points.T, axis=1)] @ self.axes)
        point = np.sign(local) * self.half
        across = np.hypot(local[:, 0], local[:, 1])
        point[:, :2] += (
            local[:, :2] * np.divide(self.disc, across, out=np.zeros_like(across), where=across > 0)[:, None]
        )
        lengths = np.linalg.norm(directions, axis=1, keepdims=True)
        outward = np.divide(directions, lengths, out=np.zeros_like(directions), where=lengths > 0)
        return np.asarray(self.position + point @ self.axes + self.ball * outward)

    def extents(self, directions: FloatArray) -> FloatArray:
        """Return the largest coordinate of the body along each of m vectors [m]. ``(m, 3)`` gives ``(m,)``."""
        local = directions @ self.axes.T
        if self.points is not None:
            furthest = (local @ self.points.T).max(axis=1)
        else:
            furthest = np.abs(local) @ self.half + self.disc * np.hypot(local[:, 0], local[:, 1])
            furthest = furthest + self.ball * np.linalg.norm(directions, axis=1)
        return np.asarray(directions @ self.position + furthest)

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


def reach_of(shape: Shape) -> float:
    """Return the radius of a ball around the origin of the body frame that contains a shape [m]."""
    solids = placed(shape, np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))
    return max(float(np.linalg.norm(solid.position)) + solid.reach for solid in solids)


def lowest_height(body: Body) -> float:
    """Return the height of the body's lowest point in the world frame [m]."""
    return min(float(part.support(np.array([0.0, 0.0, -1.0]))[2]) for part in body)
