"""Convex solids of one body that overlap each other, so that the sum of their volumes counts a volume twice."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.geometry.meshes import Hull
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import cross

MOST_SHARED = 0.01
"""Largest common volume of two solids of a body, as a fraction of the smaller solid."""
_TOUCHING = 1e-6
"""Largest depth of two solids that touch, relative to the size of the solids."""


@dataclass(frozen=True)
class Overlap:
    """Two solids with a common volume.

    Attributes:
        one: index of the first solid.
        other: index of the second solid.
        volume: common volume [m^3].
        smaller: volume of the smaller solid [m^3].
    """

    one: int
    other: int
    volume: float
    smaller: float


def find_overlap(hulls: Sequence[Hull]) -> Overlap | None:
    """Return the pair of convex solids with the largest common volume, relative to the smaller solid.

    Solids that share a face, an edge or a corner do not overlap. The result is None unless a common volume exceeds
    `MOST_SHARED` of the smaller solid.
    """
    if len(hulls) < 2:
        return None
    boxes = np.array([[hull.vertices.min(axis=0), hull.vertices.max(axis=0)] for hull in hulls])
    near = np.all((boxes[:, None, 0] < boxes[None, :, 1]) & (boxes[None, :, 0] < boxes[:, None, 1]), axis=-1)
    planes = [face_planes(hull) for hull in hulls]
    volumes = [hull.integrals[0] for hull in hulls]
    found = []
    for one, other in zip(*map(np.ndarray.tolist, np.nonzero(np.triu(near, 1))), strict=True):
        if _separated(hulls[one], planes[one], hulls[other], planes[other]):
            continue
        shared = common_volume(planes[one], planes[other])
        found.append(Overlap(one, other, shared, min(volumes[one], volumes[other])))
    worst = max(found, key=lambda overlap: overlap.volume / overlap.smaller, default=None)
    return worst if worst is not None and worst.volume > MOST_SHARED * worst.smaller else None


def face_planes(hull: Hull) -> FloatArray:
    """Return a row (outward unit normal, negative offset [m]) for each face of a hull, ``(m, 4)``."""
    corners = hull.vertices[hull.triangles]
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    sound = lengths[:, 0] > 0
    normals = normals[sound] / lengths[sound]
    # The furthest vertex defines the plane, so that small dents of the surface do not matter.
    return np.column_stack([normals, -(normals @ hull.vertices.T).max(axis=1)])


def _separated(one: Hull, own: FloatArray, other: Hull, theirs: FloatArray) -> bool:
    """Return whether a face of one of two solids separates the solids, except for rounding."""
    tolerance = _TOUCHING * max(float(np.ptp(one.vertices, axis=0).max()), float(np.ptp(other.vertices, axis=0).max()))
    return _outside(own, other, tolerance) or _outside(theirs, one, tolerance)


def _outside(planes: FloatArray, hull: Hull, tolerance: float) -> bool:
    heights = planes[:, :3] @ hull.vertices.T + planes[:, 3:]
    return bool(np.any(heights.min(axis=1) >= -tolerance))


def common_volume(one: FloatArray, other: FloatArray) -> float:
    """Return the common volume [m^3] of two convex solids that are given by the planes ``(m, 4)`` of their faces."""
    from scipy.optimize import linprog
    from scipy.spatial import ConvexHull, HalfspaceIntersection

    planes = np.unique(np.concatenate([one, other]).round(12), axis=0)
    size = float(np.abs(planes[:, 3]).max())
    # The centre of the largest ball within all planes is a point inside the common volume.
    rows = np.column_stack([planes[:, :3], np.ones(len(planes))])
    ball = linprog([0.0, 0.0, 0.0, -1.0], rows, -planes[:, 3], bounds=[(None, None)] * 3 + [(0.0, None)])
    if ball.status != 0 or ball.x[3] < _TOUCHING * size:
        return 0.0
    return float(ConvexHull(HalfspaceIntersection(planes, ball.x[:3]).intersections).volume)
