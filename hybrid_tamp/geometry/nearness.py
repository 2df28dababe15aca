"""Points near convex bodies, for many points at once, and the largest ball within a shape.

The results err on one side only, so that proofs can use them.
"""

from itertools import product

import numpy as np

from hybrid_tamp.geometry.convex import ConvexBody, placed
from hybrid_tamp.geometry.shapes import Box, Cylinder, Shape
from hybrid_tamp.motion.arrays import BoolArray, FloatArray

_UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])


def surely_within(body: ConvexBody, points: FloatArray, distance: float) -> BoolArray:
    """Return which of the points ``(n, 3)`` [m] are certainly within a distance of a body, shape ``(n,)``.

    The result is exact for boxes, cylinders and spheres. Some points that are near a hull are missed.

    Args:
        body: a convex body.
        points: positions in the world frame [m], shape ``(n, 3)``.
        distance: the distance [m]. If it is negative, no point is within it.
    """
    if distance < 0.0:
        return np.zeros(len(points), dtype=bool)
    local = (points - body.position) @ body.axes.T
    if body.points is not None:
        return _within_hull(body.points, local, distance)
    beyond = np.maximum(np.abs(local) - body.half, 0.0)
    across = np.maximum(np.hypot(beyond[:, 0], beyond[:, 1]) - body.disc, 0.0)
    return np.asarray(np.hypot(across, beyond[:, 2]) - body.ball <= distance)


def _within_hull(corners: FloatArray, points: FloatArray, distance: float) -> BoolArray:
    """Return which points are within the hull after they have moved towards its middle by at most the distance."""
    middle = corners.mean(axis=0)
    offset = points - middle
    lengths = np.maximum(np.linalg.norm(offset, axis=1, keepdims=True), 1e-12)
    moved = middle + offset * np.maximum(1.0 - distance / lengths, 0.0)
    planes = _planes(corners)
    return np.asarray((moved @ planes[:, :3].T + planes[:, 3]).max(axis=1) <= 0.0)


def _planes(corners: FloatArray) -> FloatArray:
    """Return a row (outward unit normal, negative offset [m]) for each face of a hull, shape ``(m, 4)``."""
    from scipy.spatial import ConvexHull

    return np.asarray(ConvexHull(corners).equations)


def inner_balls(shape: Shape) -> list[tuple[FloatArray, float]]:
    """Return balls that a shape contains, as pairs of centre in the body frame ``(3,)`` [m] and radius [m].

    The first one is the largest ball around the origin. Boxes and cylinders also have smaller balls at their ends.
    """
    found = [(np.zeros(3), inner_radius(shape))]
    if isinstance(shape, Box):
        half = np.asarray(shape.half_extents, dtype=float)
    elif isinstance(shape, Cylinder):
        half = np.array([0.0, 0.0, shape.length / 2.0])
    else:
        return found
    radius = found[0][1] / 2.0
    corners = np.unique(np.array(list(product((-1.0, 1.0), repeat=3))) * np.maximum(half - radius, 0.0), axis=0)
    return [*found, *((corner, radius) for corner in corners)]


def inner_radius(shape: Shape) -> float:
    """Return the radius of a ball around the origin of the body frame that the shape contains [m].

    The result is 0 if the origin is outside of all convex solids of the shape.
    """
    return max(0.0, *(_depth_of_origin(solid) for solid in placed(shape, np.zeros(3), _UPRIGHT)))


def _depth_of_origin(solid: ConvexBody) -> float:
    origin = -solid.position @ solid.axes.T
    if solid.points is not None:
        planes = _planes(solid.points)
        return -float((planes[:, :3] @ origin + planes[:, 3]).max())
    if solid.ball:
        return solid.ball - float(np.linalg.norm(origin))
    if solid.disc:
        return min(solid.disc - float(np.hypot(origin[0], origin[1])), float(solid.half[2] - abs(origin[2])))
    return float((solid.half - np.abs(origin)).min())
