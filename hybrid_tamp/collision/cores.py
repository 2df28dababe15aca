"""Convex solids for the library python-fcl, each without its outermost layer.

The library computes distances of solids that are apart. For solids that overlap or touch, e.g. a drum on a table, its
signed distances may be wrong, and some requests end the process or never return. So each solid loses a layer, and the
thickness of the layers is subtracted from the distance of the cores. Solids in contact then have cores that are apart.
If solids overlap, cores with thicker layers are apart.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from hybrid_tamp.geometry.convex import ConvexBody, placed
from hybrid_tamp.geometry.meshes import Hull
from hybrid_tamp.geometry.shapes import Shape, solids_of
from hybrid_tamp.motion.arrays import FloatArray

LAYER = 2e-3
"""Thickness of the layer that a solid loses [m], if the solid is thick enough."""
CORNER_ERROR = (np.sqrt(3.0) - 1.0) * LAYER
"""Largest amount by which a distance from the corner of a solid is too large [m], because the layer is rounded."""
DEPTHS = (0.25, 0.5, 0.75, 0.98)
"""Thicknesses of the layers for solids that overlap, as fractions of the solid's half thickness."""
_MOST = 0.5
"""Largest fraction of a solid's half thickness that the thinnest layer takes."""
_UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Core:
    """A convex solid without its outermost layer.

    Attributes:
        geometry: solid in the form of python-fcl.
        layer: thickness of the layer that is missing [m].
        position: position of the solid in the body frame [m], shape ``(3,)``.
        axes: axes of the solid in the body frame, one per row, shape ``(3, 3)``.
    """

    geometry: Any
    layer: float
    position: FloatArray
    axes: FloatArray


def make_cores(shape: Shape, depth: float | None = None) -> tuple[Core, ...]:
    """Return the cores of a shape's convex solids, with layers of `LAYER`, or of a fraction of the half thickness."""
    solids = placed(shape, np.zeros(3), _UPRIGHT)
    return tuple(_make_core(part, solid, depth) for part, solid in zip(solids_of(shape), solids, strict=True))


def _make_core(part: Any, solid: ConvexBody, depth: float | None) -> Core:
    half = _half_thickness(solid)
    layer = min(LAYER, _MOST * half) if depth is None else depth * half
    return Core(_geometry(part, solid.shrunk(layer)), layer, solid.position, solid.axes)


def _half_thickness(solid: ConvexBody) -> float:
    if solid.points is not None:
        return float(np.ptp(solid.points, axis=0).min()) / 2.0
    if solid.ball:
        return solid.ball
    return min(solid.disc, float(solid.half[2])) if solid.disc else float(solid.half.min())


def _geometry(part: Any, solid: ConvexBody) -> Any:
    import fcl

    if isinstance(part, Hull):
        faces = np.concatenate([np.full((len(part.triangles), 1), 3), part.triangles], axis=1).ravel()
        return fcl.Convex(solid.points, len(part.triangles), faces)
    if solid.ball:
        return fcl.Sphere(solid.ball)
    return fcl.Cylinder(solid.disc, 2.0 * solid.half[2]) if solid.disc else fcl.Box(*(2.0 * solid.half))
