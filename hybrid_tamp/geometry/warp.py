"""Warp the surface of a labelled object onto a new one, together with points on it.

Non-rigid registration by locally affine regularisation (Amberg, Romdhani and Vetter 2007, "Optimal Step Nonrigid ICP
Algorithms for Surface Registration"), in trimesh's implementation. The paper's Sec. III-A transfers contact points to
new objects by non-parametric shape warping (Hillenbrand 2010).
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
"""Number of edges into which the longest edge of the labelled surface is cut."""
_TARGET_EDGES = 30
"""Number of edges into which the longest extent of the new surface is cut; its corners are matched."""


@dataclass(frozen=True, eq=False)
class Warp:
    """A surface before and after the warp.

    Attributes:
        before: vertices of the labelled surface ``(n, 3)`` [m] in its own body frame.
        after: the same vertices on the new surface, in its body frame.
        triangles: indices of vertices ``(m, 3)``.
        residual: mean distance of `after` from the new surface [m].
    """

    before: FloatArray
    after: FloatArray
    triangles: NDArray[np.intp]
    residual: float

    def carry(self, points: FloatArray) -> FloatArray:
        """Return the warped positions of points on the labelled surface ``(k, 3)`` [m]."""
        corners = self.before[self.triangles]
        return np.array([self._carried(point, corners) for point in np.asarray(points)])

    def _carried(self, point: FloatArray, corners: FloatArray) -> FloatArray:
        """Return the warped position of a point, by its weights over the corners of its nearest triangle."""
        edges = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=-1)
        inner = np.einsum("mij,mi->mj", np.linalg.pinv(edges).transpose(0, 2, 1), point - corners[:, 0])
        weights = np.clip(np.column_stack([1.0 - inner.sum(axis=1), inner]), 0.0, 1.0)
        weights /= weights.sum(axis=1, keepdims=True)
        distances = np.linalg.norm(np.einsum("mc,mci->mi", weights, corners) - point, axis=1)
        nearest = int(np.argmin(distances))
        return np.asarray(weights[nearest] @ self.after[self.triangles[nearest]])


def warp(labelled: Shape, new: Shape, rotation: FloatArray) -> Warp:
    """Warp a labelled shape onto a new one.

    Args:
        labelled: the shape with known points.
        new: the shape onto which the points are transferred.
        rotation: initial rotation ``(3, 3)`` from the labelled shape's frame to the new one's. The labelled shape is
            then scaled to the new one's bounding box, so that the registration finds only the form.
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
    """Return the vertices and triangles of a surface after cutting all edges longer than `edge` [m]."""
    from trimesh.remesh import subdivide_to_size

    vertices, triangles = subdivide_to_size(surface.vertices, surface.faces, max_edge=edge, max_iter=20)
    return vertices, triangles


def _subdivided(shape: Shape, edges: int) -> tuple[FloatArray, NDArray[np.intp]]:
    """Return the vertices and triangles of a surface, cut so that no edge is much longer than the others."""
    surface = outer_surface(shape)
    size = float(np.ptp(surface.vertices, axis=0).max())
    vertices, triangles = _cut(surface, 1.5 * size / edges)
    unique, names = np.unique(np.round(vertices / (1e-6 * size)), axis=0, return_inverse=True)
    merged = np.zeros_like(unique)
    merged[names.ravel()] = vertices
    return merged, names.ravel()[triangles].astype(np.intp)
