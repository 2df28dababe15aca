"""Agreement of an axis and a radius of rotation with the shape that rolls."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hybrid_tamp.geometry.agreement import (
    APPROXIMATE,
    EXACT,
    Disagreement,
    ShapeFeature,
    compare,
    extents_of,
    numbers,
)
from hybrid_tamp.geometry.features import across
from hybrid_tamp.geometry.shapes import Cylinder, Shape, Sphere
from hybrid_tamp.motion.arrays import FloatArray

MOST_OFF_AXIS = np.radians(1.0)
"""Largest angle between an axis of rotation and the axis of a cylinder [rad]."""
LEAST_ROUND = 0.75
"""Smallest roundness of a body that rolls. A square prism has a roundness of 0.71, and a pentagonal prism of 0.81."""
MOST_LESS_ROUND = 0.05
"""Largest difference between the roundness about the axis of rotation and the roundness about the roundest axis."""
_DIRECTIONS = 720


def outline_of(shape: Shape, axis: FloatArray) -> FloatArray:
    """Return how far ``(n,)`` [m] a shape extends from an axis through its centre, in n directions across the axis."""
    one, other = across(axis)
    angles = np.linspace(0.0, 2.0 * np.pi, _DIRECTIONS, endpoint=False)[:, None]
    return extents_of(shape, np.cos(angles) * one + np.sin(angles) * other)


@dataclass(frozen=True)
class AxisOfRotation(ShapeFeature):
    """An axis about which the shape is round.

    This axis is the axis of a cylinder, or any axis of a sphere. The *roundness* of another shape about an axis is the
    ratio of its smallest to its largest extent across the axis.
    """

    def find_fault(self, value: Any, shape: Shape, properties: Mapping[str, Any]) -> Disagreement | None:
        """Return the axis of the shape if the value differs, or the roundness of a shape that is not round."""
        axis = np.asarray(value) / np.linalg.norm(value)
        if isinstance(shape, Sphere):
            return None
        if isinstance(shape, Cylinder):
            off = float(np.arctan2(np.hypot(axis[0], axis[1]), abs(axis[2])))
            if off <= MOST_OFF_AXIS:
                return None
            wanted = f"must be along the axis of the cylinder, [0, 0, 1], within {np.degrees(MOST_OFF_AXIS):.3g} degree"
            return Disagreement(wanted, f"{numbers(axis)}, which is {np.degrees(off):.3g} degrees off")
        ratio = _roundness(shape, axis)
        best, along = max((_roundness(shape, each), tuple(each)) for each in np.eye(3))
        came = f"{numbers(axis)}, with a ratio of {ratio:.3g}"
        measure = "the ratio of the smallest to the largest extent across the axis"
        if max(ratio, best) < LEAST_ROUND:
            return Disagreement(
                f"must be an axis about which the shape is round: {measure} must be at least {LEAST_ROUND}", came
            )
        if ratio >= best - MOST_LESS_ROUND:
            return None
        wanted = f"must be along the round axis of the shape, {numbers(along)}: {measure} is {best:.3g}"
        return Disagreement(f"{wanted} there, and may be less by at most {MOST_LESS_ROUND}", came)


def _roundness(shape: Shape, axis: FloatArray) -> float:
    outline = outline_of(shape, axis)
    return float(outline.min() / outline.max())


@dataclass(frozen=True)
class RadiusOfRotation(ShapeFeature):
    """The radius with which the shape rolls about an axis [m].

    The radius of a mesh or compound is the circumference of its convex outline across the axis, divided by 2 pi. This
    is the mean extent across the axis (Cauchy), and the distance that the shape rolls per radian.

    Attributes:
        axis: name of the property with the axis.
    """

    axis: str = "axis_of_rotation"

    def find_fault(self, value: Any, shape: Shape, properties: Mapping[str, Any]) -> Disagreement | None:
        """Return the radius of the shape if the value differs. A wrong axis is a fault of the axis only."""
        axis = properties[self.axis]
        if AxisOfRotation().find_fault(axis, shape, properties) is not None:
            return None
        if isinstance(shape, Cylinder | Sphere):
            return compare(value, shape.radius, EXACT, "the radius of the shape")
        radius = float(outline_of(shape, np.asarray(axis)).mean())
        return compare(value, radius, APPROXIMATE, "the circumference of the shape across its axis, divided by 2 pi")
