"""Convex solids for the library python-fcl, each without its outermost layer.

The library computes distances of solids that are apart. For solids that overlap or touch, e.g. a drum on a table, its
signed distances may be wrong, and some requests end the process or never return. So each solid loses a layer, and the
thickness of the layers is subtracted from the distance of the cores. Solids in contact then have cores that are apart.
If solids overlap, cores with thicker layers are apart.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from hybrid_tamp.geometry.meshes import Hull
from hybrid_tamp.geometry.shapes import Box, Cylinder, Shape, solids_of
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rpy

LAYER = 2e-3
"""Thickness of the layer that a solid loses [m], if the solid is thick enough."""
CORNER_ERROR = (np.sqrt(3.0) - 1.0) * LAYER
"""Largest amount by which a distance from the corner of a solid is too large [m], because the layer is rounded."""
DEPTHS = (0.25, 0.5, 0.75, 0.98)
"""Thicknesses of the layers for solids that overlap, as fractions of the solid's half thickness."""
_MOST = 0.5
"""Largest fraction of a solid's half thickness that the thinnest layer takes."""


@dataclass(frozen=True)
class Core:
    """A convex solid without its outermost layer.

    Attributes:
        geometry: solid in the form of python-fcl.
        layer: thickness of the layer that is missing [m].
        position: position of the solid in the body frame [m], shape ``(3,)``.
        orientation: orientation of the solid in the body frame, shape ``(4,)``.
    """

    geometry: Any
    layer: float
    position: FloatArray
    orientation: FloatArray


def make_cores(shape: Shape, depth: float | None = None) -> tuple[Core, ...]:
    """Return the cores of a shape's convex solids, with layers of `LAYER`, or of a fraction of the half thickness."""
    return tuple(_make_core(part, depth) for part in solids_of(shape))


def _make_core(part: Any, depth: float | None) -> Core:
    import fcl

    position, orientation = np.asarray(part.position, dtype=float), quaternion_from_rpy(part.rpy)
    if isinstance(part, Hull):
        geometry, layer = _shrink_hull(part, depth)
    elif isinstance(part, Box):
        layer = _layer(min(part.half_extents), depth)
        geometry = fcl.Box(*(2.0 * (half - layer) for half in part.half_extents))
    elif isinstance(part, Cylinder):
        layer = _layer(min(part.radius, part.length / 2.0), depth)
        geometry = fcl.Cylinder(part.radius - layer, part.length - 2.0 * layer)
    else:
        layer = _layer(part.radius, depth)
        geometry = fcl.Sphere(part.radius - layer)
    return Core(geometry, layer, position, orientation)


def _layer(half: float, depth: float | None) -> float:
    return min(LAYER, _MOST * half) if depth is None else depth * half


def _shrink_hull(hull: Hull, depth: float | None) -> tuple[Any, float]:
    """Return a convex hull that is scaled towards its centre, and the distance by which its nearest face moves [m]."""
    import fcl

    corners = hull.vertices[hull.triangles]
    centre = hull.vertices.mean(axis=0)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    flat = lengths > 0
    depths = np.einsum("mi,mi->m", normals[flat] / lengths[flat, None], corners[flat, 0] - centre)
    # The nearest face moves least, so the distance of the original hull is never overestimated at a face.
    share = _layer(float(depths.min()), depth) / float(depths.min())
    vertices = centre + (hull.vertices - centre) * (1.0 - share)
    faces = np.concatenate([np.full((len(hull.triangles), 1), 3), hull.triangles], axis=1).ravel()
    return fcl.Convex(vertices, len(hull.triangles), faces), share * float(depths.min())
