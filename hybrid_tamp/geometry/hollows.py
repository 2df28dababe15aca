"""Depth of the hollows in the faces of a shape."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hybrid_tamp.geometry.agreement import APPROXIMATE, Disagreement, ShapeFeature, extents_of, numbers
from hybrid_tamp.geometry.common_volume import face_planes
from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.geometry.surfaces import hulls_of
from hybrid_tamp.motion.arrays import FloatArray

_RAYS = 15
"""Number of rays along each edge of a face."""
_INNER = 0.98
"""Part of the extent along each edge that the rays cover."""
_MOST_PAIRS = 5_000_000
"""Largest number of pairs of a ray and a plane that are computed at once."""


@dataclass(frozen=True)
class HollowDepths(ShapeFeature):
    """Depths of hollows in the faces of the bounding box, along the x, y and z axes of the body frame [m].

    A hollow can be less deep where hands touch it, so the property may be smaller than the depth.
    """

    def find_fault(self, value: Any, shape: Shape, properties: Mapping[str, Any]) -> Disagreement | None:
        """Return the depths of the shape's hollows if a given depth is larger."""
        given = np.asarray(value)
        if not given.any():
            return None
        depths = hollow_depths(shape)
        if np.all(given <= depths + APPROXIMATE * extents_of(shape, np.eye(3))):
            return None
        wanted = f"must be at most the depths of the hollows of the shape, {numbers(depths.round(6))} m"
        return Disagreement(f"{wanted}, within {APPROXIMATE:.0%} of its half extents", f"{numbers(given)} m")


def hollow_depths(shape: Shape) -> FloatArray:
    """Return how deep ``(3,)`` [m] the surface of a shape is behind the faces of its bounding box, along each axis."""
    planes = [face_planes(hull) for hull in hulls_of(shape)]
    upper, lower = extents_of(shape, np.eye(3)), -extents_of(shape, -np.eye(3))
    return np.array([_depth(planes, upper, lower, axis) for axis in range(3)])


def _depth(planes: list[FloatArray], upper: FloatArray, lower: FloatArray, axis: int) -> float:
    across = [other for other in range(3) if other != axis]
    shares = (1.0 + _INNER * np.linspace(-1.0, 1.0, _RAYS)) / 2.0
    origins = np.zeros((_RAYS**2, 3))
    for other, share in zip(across, np.meshgrid(shares, shares), strict=True):
        origins[:, other] = lower[other] + share.ravel() * (upper[other] - lower[other])
    highest, lowest = np.full(len(origins), -np.inf), np.full(len(origins), np.inf)
    for part in planes:
        for rows in np.array_split(np.arange(len(origins)), 1 + len(origins) * len(part) // _MOST_PAIRS):
            entry, leave = _pierce(part, origins[rows], axis)
            met = entry <= leave
            highest[rows] = np.maximum(highest[rows], np.where(met, leave, -np.inf))
            lowest[rows] = np.minimum(lowest[rows], np.where(met, entry, np.inf))
    met = np.isfinite(highest)
    return float(max((upper[axis] - highest[met]).max(initial=0.0), (lowest[met] - lower[axis]).max(initial=0.0)))


def _pierce(planes: FloatArray, origins: FloatArray, axis: int) -> tuple[FloatArray, FloatArray]:
    """Return where rays along an axis enter and leave a convex solid [m]. A ray that misses enters after it leaves."""
    slopes, heights = planes[:, axis], origins @ planes[:, :3].T + planes[:, 3]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossings = -heights / slopes
    parallel = np.abs(slopes) < 1e-12
    leave = np.where(parallel | (slopes < 0), np.inf, crossings).min(axis=1)
    entry = np.where(parallel | (slopes > 0), -np.inf, crossings).max(axis=1)
    outside = np.any(heights[:, parallel] > 1e-12, axis=1)
    return np.where(outside, np.inf, entry), np.where(outside, -np.inf, leave)
