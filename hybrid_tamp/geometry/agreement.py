"""Features of a shape with which properties must agree, e.g. the radius of a cylinder.

A class declares the feature of each such property in `ObjectClass.of_shape`. A task file whose property disagrees with
the shape is refused with both figures.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hybrid_tamp.geometry.common_volume import face_planes
from hybrid_tamp.geometry.convex import placed
from hybrid_tamp.geometry.gaps import distance_to_point
from hybrid_tamp.geometry.meshes import MeshShape
from hybrid_tamp.geometry.moments import distance_outside, largest_share
from hybrid_tamp.geometry.shapes import Box, Cylinder, Shape, Sphere
from hybrid_tamp.geometry.surfaces import hulls_of
from hybrid_tamp.motion.arrays import FloatArray

EXACT, APPROXIMATE = 0.01, 0.03
"""Largest relative difference between a property and a box, cylinder or sphere, and a mesh or compound."""
NEAR = 0.02
"""Largest distance of a point from the shape, relative to the longest edge of the shape's bounding box."""
_WHOLE = np.array([0.0, 0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Disagreement:
    """A disagreement of a property with the shape of its token.

    Attributes:
        wanted: the requirement, as the end of a sentence that begins with the property, e.g. ``must be 0.1 m``.
        came: the given value.
    """

    wanted: str
    came: str


class ShapeFeature(ABC):
    """A feature of a shape with which a property must agree."""

    @abstractmethod
    def find_fault(self, value: Any, shape: Shape, properties: Mapping[str, Any]) -> Disagreement | None:
        """Return how a property disagrees with the shape, or None if they agree.

        Args:
            value: value of the property.
            shape: shape of the token.
            properties: all properties of the token.
        """


def numbers(values: Sequence[float] | FloatArray) -> str:
    """Return numbers as text, e.g. ``[0, 0.1, 0.25]``."""
    return f"[{', '.join(f'{float(value) + 0.0:.4g}' for value in values)}]"


def extents_of(shape: Shape, directions: FloatArray) -> FloatArray:
    """Return how far ``(m,)`` [m] a shape extends from the origin of its frame along unit vectors ``(m, 3)``."""
    return np.asarray(np.max([part.extents(directions) for part in placed(shape, np.zeros(3), _WHOLE)], axis=0))


def length_of(shape: Shape) -> float:
    """Return the longest edge [m] of a shape's bounding box."""
    return float((extents_of(shape, np.eye(3)) + extents_of(shape, -np.eye(3))).max())


@dataclass(frozen=True)
class HalfExtents(ShapeFeature):
    """Half of the edge lengths of the shape's bounding box, whose centre is the origin of the body frame [m]."""

    def find_fault(self, value: Any, shape: Shape, properties: Mapping[str, Any]) -> Disagreement | None:
        """Return the larger and the smaller corner of the shape if the half extents differ."""
        share = EXACT if isinstance(shape, Box | Cylinder | Sphere) else APPROXIMATE
        upper, lower = extents_of(shape, np.eye(3)), -extents_of(shape, -np.eye(3))
        halves = np.asarray(value)
        if np.all(np.abs(np.array([upper, -lower]) - halves) <= share * halves):
            return None
        said = f"must match the {kind_of(shape)}, which extends from {numbers(lower)} m to {numbers(upper)} m"
        return Disagreement(f"{said}, within {share:.0%}", f"{numbers(halves)} m")


@dataclass(frozen=True)
class CylinderSize(ShapeFeature):
    """The radius or the length of a cylinder [m].

    Attributes:
        name: ``radius`` or ``length``.
    """

    name: str

    def find_fault(self, value: Any, shape: Shape, properties: Mapping[str, Any]) -> Disagreement | None:
        """Return the size of the cylinder if the value differs, or the kind of another shape."""
        if not isinstance(shape, Cylinder):
            return Disagreement(f"must be the {self.name} of a cylinder", f"a {kind_of(shape)} as shape")
        return compare(value, getattr(shape, self.name), EXACT, f"the {self.name} of the shape")


def kind_of(shape: Shape) -> str:
    """Return the kind of a shape, e.g. ``cylinder``."""
    return "mesh" if isinstance(shape, MeshShape) else shape.kind


def compare(value: float, actual: float, share: float, what: str) -> Disagreement | None:
    """Return the disagreement of a length [m] with the actual length of the shape, or None within a relative share."""
    if abs(value - actual) <= share * actual:
        return None
    return Disagreement(f"must be {actual:.4g} m within {share:.0%}, {what}", f"{value:.4g} m")


@dataclass(frozen=True)
class PointWithin(ShapeFeature):
    """A point of the body frame within the shape [m]."""

    def find_fault(self, value: Any, shape: Shape, properties: Mapping[str, Any]) -> Disagreement | None:
        """Return the distance of the point from the shape if it is too large."""
        distance, most = _distance(shape, np.asarray(value)), NEAR * length_of(shape)
        if distance <= most:
            return None
        return Disagreement(f"must be within {most:.2g} m of the shape", f"{numbers(value)} m, {distance:.3g} m away")


@dataclass(frozen=True)
class PointOnSurface(ShapeFeature):
    """A point of the shape's surface, in the body frame [m]."""

    def find_fault(self, value: Any, shape: Shape, properties: Mapping[str, Any]) -> Disagreement | None:
        """Return how deep inside the shape or how far from the shape the point is, if it is not on the surface."""
        off = PointWithin().find_fault(value, shape, properties)
        most = NEAR * length_of(shape)
        heights = [face_planes(hull) @ np.append(np.asarray(value, dtype=float), 1.0) for hull in hulls_of(shape)]
        depth = -min(float(each.max()) for each in heights)
        if off is not None or depth <= most:
            return off
        wanted = f"must be on the surface of the shape, within {most:.2g} m"
        return Disagreement(wanted, f"{numbers(value)} m, {depth:.3g} m inside")


def _distance(shape: Shape, point: FloatArray) -> float:
    return min(distance_to_point(part, point) for part in placed(shape, np.zeros(3), _WHOLE))


@dataclass(frozen=True)
class MomentsOfInertia(ShapeFeature):
    """Principal moments of inertia of a body whose mass is anywhere within the shape's convex hull [kg m^2]."""

    def find_fault(self, value: Any, shape: Shape, properties: Mapping[str, Any]) -> Disagreement | None:
        """Return the bound that the moments exceed: the sum of the other two moments, or the largest moments."""
        moments, mass = np.asarray(value, dtype=float), float(properties.get("mass", 1.0))
        came = f"{numbers(moments)} kg m^2"
        others = float(moments.sum() - moments.max())
        if float(moments.max()) > (1.0 + EXACT) * others:
            wanted = (
                f"must be moments of a rigid body, of which none exceeds the sum of the other two, {others:.4g} kg m^2"
            )
            return Disagreement(wanted, came)
        if distance_outside(shape) > 0:
            return None
        share = largest_share(shape, moments, mass)
        if (1.0 + EXACT) * share >= 1.0:
            return None
        most = numbers(share * moments)
        wanted = f"must be moments of {mass:.4g} kg within the shape, which in this ratio are at most {most} kg m^2"
        return Disagreement(f"{wanted}, within {EXACT:.0%}", came)
