"""Outer surfaces of shapes, as meshes in the body frame."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from hybrid_tamp.geometry.meshes import Hull
from hybrid_tamp.geometry.shapes import Shape, solids_of
from hybrid_tamp.geometry.triangles import solid
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rpy

if TYPE_CHECKING:
    from trimesh import Trimesh

_OUTSIDE = 1e-5
"""Distance of a test point from a triangle [m]. If another solid contains the test point, the triangle is covered."""


def hulls_of(shape: Shape) -> list[Hull]:
    """Return the convex solids of a shape as triangle meshes in the body frame. Round solids are approximated."""
    meshes = [solid(part).turned(quaternion_from_rpy(part.rpy)).moved(part.position) for part in solids_of(shape)]
    return [Hull(mesh.vertices, mesh.triangles) for mesh in meshes]


def points_of(shape: Shape) -> FloatArray:
    """Return points that have the same convex hull as the shape, in the body frame [m], shape ``(n, 3)``."""
    return np.concatenate([hull.vertices for hull in hulls_of(shape)])


def volume_of(shape: Shape) -> float:
    """Return the sum of the volumes of a shape's solids [m^3]. Overlaps between solids are counted twice."""
    return sum(hull.integrals[0] for hull in hulls_of(shape))


def outer_surface(shape: Shape) -> "Trimesh":
    """Return the outer surface of a shape, without triangles that other solids of the shape cover."""
    from trimesh import Trimesh

    hulls = hulls_of(shape)
    vertices, triangles, first = [], [], 0
    for number, hull in enumerate(hulls):
        others = hulls[:number] + hulls[number + 1 :]
        vertices.append(hull.vertices)
        triangles.append(hull.triangles[_uncovered(hull, others)] + first)
        first += len(hull.vertices)
    surface = Trimesh(np.concatenate(vertices), np.concatenate(triangles))
    surface.merge_vertices(merge_norm=True)
    surface.remove_unreferenced_vertices()
    return surface


def _uncovered(hull: Hull, others: Sequence[Hull]) -> FloatArray:
    """Return a mask of the triangles that no other solid covers, shape ``(m,)``."""
    corners, normals = _planes(hull)
    outside = corners.mean(axis=1) + normals * _OUTSIDE
    covered = np.zeros(len(outside), dtype=bool)
    for other in others:
        lower, upper = other.vertices.min(axis=0), other.vertices.max(axis=0)
        near = np.flatnonzero(np.all((outside > lower) & (outside < upper), axis=1))
        theirs, outward = _planes(other)
        heights = np.einsum("qfi,fi->qf", outside[near, None] - theirs[None, :, 0], outward)
        covered[near] |= np.all(heights <= 0.0, axis=1)
    return np.asarray(~covered)


def _planes(hull: Hull) -> tuple[FloatArray, FloatArray]:
    corners = hull.vertices[hull.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return corners, normals / np.linalg.norm(normals, axis=1, keepdims=True)
