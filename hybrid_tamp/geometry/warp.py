"""Warp of the surface of a labelled object onto a new object. The warp transfers points between the objects.

The warp is a non-rigid registration with locally affine regularisation (Amberg, Romdhani and Vetter 2007, "Optimal Step
Nonrigid ICP Algorithms for Surface Registration"), as implemented in trimesh. The paper (Sec. III-A) transfers contact
points to new objects by another method, non-parametric shape warping (Hillenbrand 2010).
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.geometry.surfaces import outer_surface
from hybrid_tamp.motion.arrays import FloatArray

if TYPE_CHECKING:
    from trimesh import Trimesh

_SOURCE_EDGES = 8
"""Approximate number of edges along the largest extent of the labelled surface after subdivision."""
_TARGET_EDGES = 30
"""Number of edges along the new surface's largest extent after subdivision. The warp matches vertices to vertices."""


@dataclass(frozen=True, eq=False)
class Warp:
    """The surface of a labelled object before and after the warp.

    Attributes:
        before: vertices of the labelled surface in the body frame of the labelled object [m], shape ``(n, 3)``.
        after: warped vertices in the body frame of the new object [m], shape ``(n, 3)``.
        triangles: indices of the vertices of each triangle, shape ``(m, 3)``.
        residual: mean distance between the warped vertices and the new surface [m].
    """

    before: FloatArray
    after: FloatArray
    triangles: NDArray[np.intp]
    residual: float

    def carry(self, points: FloatArray) -> FloatArray:
        """Return the warped positions of points on the labelled surface [m], shape ``(k, 3)``."""
        corners = self.before[self.triangles]
        return np.array([self._carried(point, corners) for point in np.asarray(points)])

    def _carried(self, point: FloatArray, corners: FloatArray) -> FloatArray:
        """Return the warped position of a point, interpolated between the corners of the nearest triangle."""
        edges = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=-1)
        inner = np.einsum("mij,mi->mj", np.linalg.pinv(edges).transpose(0, 2, 1), point - corners[:, 0])
        weights = np.clip(np.column_stack([1.0 - inner.sum(axis=1), inner]), 0.0, 1.0)
        weights /= weights.sum(axis=1, keepdims=True)
        distances = np.linalg.norm(np.einsum("mc,mci->mi", weights, corners) - point, axis=1)
        nearest = int(np.argmin(distances))
        return np.asarray(weights[nearest] @ self.after[self.triangles[nearest]])


def warp(labelled: Shape, new: Shape, rotation: FloatArray) -> Warp:
    """Warp a labelled shape onto a new shape.

    Args:
        labelled: shape with known points.
        new: shape onto which the points are transferred.
        rotation: initial rotation from the frame of the labelled shape to the frame of the new shape, shape ``(3, 3)``.
            The rotated shape is scaled to the bounding box of the new shape before the registration.
    """
    from scipy.spatial import cKDTree
    from trimesh import Trimesh
    from trimesh.registration import nricp_amberg

    before, triangles = _subdivided(labelled, _SOURCE_EDGES)
    surface = outer_surface(new)
    edge = float(np.ptp(surface.vertices, axis=0).max()) / _TARGET_EDGES
    target = Trimesh(*_cut(surface, edge), process=False)
    turned = before @ rotation.T
    lower, upper = turned.min(axis=0), turned.max(axis=0)
    corner, extent = target.vertices.min(axis=0), np.ptp(target.vertices, axis=0)
    start = Trimesh(corner + (turned - lower) / (upper - lower) * extent, triangles, process=False)
    after = np.asarray(nricp_amberg(start, target, use_faces=False))
    distances, _ = cKDTree(target.vertices).query(after)
    return Warp(before, after, triangles, float(distances.mean()))


def _cut(surface: "Trimesh", edge: float) -> tuple[FloatArray, NDArray[np.intp]]:
    """Return the vertices and triangles of a surface whose edges are subdivided to a length of at most `edge` [m]."""
    from trimesh.remesh import subdivide_to_size

    vertices, triangles = subdivide_to_size(surface.vertices, surface.faces, max_edge=edge, max_iter=20)
    return vertices, triangles


def _subdivided(shape: Shape, edges: int) -> tuple[FloatArray, NDArray[np.intp]]:
    """Return the vertices and triangles of a shape's surface, with long edges subdivided and equal vertices merged."""
    surface = outer_surface(shape)
    size = float(np.ptp(surface.vertices, axis=0).max())
    vertices, triangles = _cut(surface, 1.5 * size / edges)
    unique, names = np.unique(np.round(vertices / (1e-6 * size)), axis=0, return_inverse=True)
    merged = np.zeros_like(unique)
    merged[names.ravel()] = vertices
    return merged, names.ravel()[triangles].astype(np.intp)
