"""Outlines of bodies and of swept areas, as they appear in a view along an axis of the world frame.

The outline of a convex solid follows from its furthest points in many directions. The furthest points of two poses
together are those of their convex hull, so the hulls of successive poses cover the area between them.
"""

from collections.abc import Iterable
from itertools import pairwise
from math import ceil

import numpy as np

from hybrid_tamp.geometry.convex import placed
from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.model.swept import SweptBody
from hybrid_tamp.motion.arrays import FloatArray

_DIRECTIONS = 72
_MOST_POSES = 48
"""Largest number of poses of a swept area."""
_ANGLES = np.linspace(0.0, 2.0 * np.pi, _DIRECTIONS, endpoint=False)
_AROUND = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=-1)

Plane = tuple[int, int]
"""Indices of the two axes of the world frame that point to the right and upward in a view."""


def outline(shape: Shape, position: FloatArray, orientation: FloatArray, plane: Plane) -> list[FloatArray]:
    """Return the outlines of a body's convex solids as corners ``(m, 2)`` [m] in counter-clockwise order."""
    directions = np.zeros((_DIRECTIONS, 3))
    directions[:, plane] = _AROUND
    solids = placed(shape, position, orientation)
    return [solid.supports(directions)[:, plane] for solid in solids]


def disc(centre: FloatArray, radius: float) -> FloatArray:
    """Return the outline ``(m, 2)`` [m] of a disc around a centre ``(2,)``."""
    return np.asarray(centre + radius * _AROUND)


def swept_area(shape: Shape, body: SweptBody, plane: Plane) -> list[FloatArray]:
    """Return outlines ``(m, 2)`` [m] in counter-clockwise order that together cover the swept area of a body."""
    step = max(ceil((len(body.positions) - 1) / _MOST_POSES), 1)
    rows = [*range(0, len(body.positions) - 1, step), len(body.positions) - 1]
    poses = [outline(shape, body.positions[row], body.orientations[row], plane) for row in rows]
    return [*poses[0], *(_join(*pair) for both in pairwise(poses) for pair in zip(*both, strict=True))]


def _join(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the outline of the convex hull of two outlines."""
    further = np.sum(other * _AROUND, axis=-1) > np.sum(one * _AROUND, axis=-1)
    return np.where(further[:, None], other, one)


def bounds_of(outlines: Iterable[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Return the least and the greatest coordinates of outlines, each ``(2,)`` [m]."""
    corners = np.concatenate(list(outlines))
    return corners.min(axis=0), corners.max(axis=0)
