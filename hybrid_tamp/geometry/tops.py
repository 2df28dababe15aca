"""Level tops of bodies, on which other bodies can rest."""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.geometry.common_volume import face_planes
from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.geometry.surfaces import hulls_of
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate

_LEVEL = float(np.cos(np.radians(1.0)))
"""Smallest vertical component of the normal of a level face."""
_SAME = 1e-3
"""Largest vertical distance between the level faces of one top [m]."""
_DIGITS = 9
"""Number of decimal places of equal edges."""


@dataclass(frozen=True)
class Top:
    """The level top of a convex solid, in the world frame.

    Attributes:
        height: height of the top [m].
        edges: a triple (x, y, offset) for each edge. A point p of the top satisfies ``x p[0] + y p[1] <= offset``.
            (x, y) is the outward unit normal of the edge, and the offset is in metres.
    """

    height: float
    edges: tuple[tuple[float, float, float], ...]

    def depth(self, points: FloatArray) -> FloatArray:
        """Return how deep points ``(..., 2)`` [m] lie within the outline, shape ``(...)`` [m]. Negative outside."""
        edges = np.array(self.edges)
        return np.asarray((edges[:, 2] - points @ edges[:, :2].T).min(axis=-1))


def find_tops(shape: Shape, position: FloatArray, orientation: FloatArray) -> tuple[Top, ...]:
    """Return the level tops of the convex solids of a shape. A solid without a level face on top has no top.

    Args:
        shape: the shape. Round solids are approximated.
        position: position of the body [m], shape ``(3,)``.
        orientation: orientation of the body as a unit quaternion, shape ``(4,)``.
    """
    tops = []
    for hull in hulls_of(shape):
        planes = face_planes(hull)
        normals = rotate(orientation, planes[:, :3])
        # A point p in the world is behind a face if normals @ p <= limits.
        limits = normals @ position - planes[:, 3]
        height = float((rotate(orientation, hull.vertices) + position)[:, 2].max())
        level = normals[:, 2] >= _LEVEL
        if np.any(height - limits[level] / normals[level, 2] <= _SAME):
            tops.append(Top(height, _edges(normals, limits, height)))
    return tuple(tops)


def _edges(normals: FloatArray, limits: FloatArray, height: float) -> tuple[tuple[float, float, float], ...]:
    """Return the edges in which the faces of a solid cut the horizontal plane at a height [m]."""
    across = np.hypot(normals[:, 0], normals[:, 1])
    steep = across > np.sqrt(1.0 - _LEVEL**2)
    offsets = (limits - normals[:, 2] * height)[steep] / across[steep]
    edges = np.column_stack([normals[steep, :2] / across[steep, None], offsets])
    return tuple((float(x), float(y), float(offset)) for x, y, offset in np.unique(edges.round(_DIGITS), axis=0) + 0.0)
