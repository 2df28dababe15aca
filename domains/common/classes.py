"""Object classes that several domains use, and what they are made of."""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator

from hybrid_tamp.authoring import (
    BasicAction,
    Box,
    CapabilityClass,
    Cylinder,
    PlaceClass,
    Shape,
    Token,
    Vector3,
    quantity,
)


def _all_positive(vector: Vector3) -> Vector3:
    if min(vector) <= 0:
        raise ValueError("all three must be greater than 0")
    return vector


Extents = Annotated[Vector3, AfterValidator(_all_positive)]
"""Half of the edge lengths of a box."""


def positive(unit: str, description: str, most: float, **default: float) -> Any:
    """Declare a finite property greater than 0 and at most `most`."""
    return quantity(unit, description, **default, gt=0, le=most, strict=True, allow_inf_nan=False)


def not_negative(unit: str, description: str, most: float, **default: float) -> Any:
    """Declare a finite property from 0 to `most`."""
    return quantity(unit, description, **default, ge=0, le=most, strict=True, allow_inf_nan=False)


# A token may be a member of several classes only if they declare a common property in the same way.
def mass_property() -> Any:
    """Declare the mass of a body."""
    return positive("kg", "mass", 1e6)


def friction_property() -> Any:
    """Declare the friction coefficient of a body."""
    return not_negative("1", "Coulomb friction coefficient", 5)


class BoxShaped:
    """Part of every class whose members are boxes of their half extents unless they have another shape."""

    @classmethod
    def default_shape(cls, properties: Mapping[str, Any]) -> Shape | None:
        """Return the box of the half extents."""
        return Box(kind="box", half_extents=properties["half_extents"])


def find_box_fault(token: Token, other_shape: str) -> str | None:
    """Return a complaint about a shape that is not the box of the half extents, or None.

    Args:
        token: the token.
        other_shape: the complaint about a shape that is no box.
    """
    halves = token["half_extents"]
    if not isinstance(token.shape, Box):
        return other_shape
    if any(abs(one - other) > 0.01 * one for one, other in zip(halves, token.shape.half_extents, strict=True)):
        return f"half_extents are {halves} m, but those of its shape are {token.shape.half_extents} m"
    return None


class StaticEndEffector(CapabilityClass):
    """A hand that can push objects and cannot grasp (paper, Sec. II-A)."""

    name: ClassVar[str] = "STATIC END-EFFECTOR"
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (
        BasicAction("force", 3, "N", "maximal_force", "force on the hand in the world, gravity compensated"),
    )

    radius: float = positive("m", "radius of the cylindrical hand", 10)
    length: float = positive("m", "length of the cylindrical hand", 10)
    mass: float = mass_property()
    maximal_force: float = positive("N", "largest force the hand can exert", 1e7)
    workspace_lower: Vector3 = quantity("m", "lower corner of the box that the hand's centre can reach")
    workspace_upper: Vector3 = quantity("m", "upper corner of the box that the hand's centre can reach")

    @classmethod
    def default_shape(cls, properties: Mapping[str, Any]) -> Shape | None:
        """Return the cylinder of the hand."""
        return Cylinder(kind="cylinder", radius=properties["radius"], length=properties["length"])

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Complain about a workspace whose corners are in the wrong order."""
        lower, upper = token["workspace_lower"], token["workspace_upper"]
        if any(low >= high for low, high in zip(lower, upper, strict=True)):
            return "workspace_lower must lie below workspace_upper in x, y and z"
        return None


class Region(PlaceClass):
    """A disc on the floor: somewhere to bring things to."""

    name: ClassVar[str] = "REGION"

    radius: float = positive("m", "how far from its centre still counts as inside", 100)
