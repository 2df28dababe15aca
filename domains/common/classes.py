"""Object classes that several domains use."""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator

from hybrid_tamp.authoring import BasicAction, CapabilityClass, Cylinder, PlaceClass, Shape, Token, Vector3, quantity


def _all_positive(vector: Vector3) -> Vector3:
    if min(vector) <= 0:
        raise ValueError("all three must be greater than 0")
    return vector


Extents = Annotated[Vector3, AfterValidator(_all_positive)]
"""Half of the edge lengths of a box."""


class StaticEndEffector(CapabilityClass):
    """A hand that can push objects and cannot grasp (paper, Sec. II-A)."""

    name: ClassVar[str] = "STATIC END-EFFECTOR"
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (
        BasicAction("force", 3, "N", "maximal_force", "force on the hand in the world, gravity compensated"),
    )

    radius: float = quantity("m", "radius of the cylindrical hand", gt=0, le=10, strict=True, allow_inf_nan=False)
    length: float = quantity("m", "length of the cylindrical hand", gt=0, le=10, strict=True, allow_inf_nan=False)
    mass: float = quantity("kg", "mass", gt=0, le=1e6, strict=True, allow_inf_nan=False)
    maximal_force: float = quantity(
        "N", "largest force the hand can exert", gt=0, le=1e7, strict=True, allow_inf_nan=False
    )
    workspace_lower: Vector3 = quantity("m", "lower corner of the box that the hand's centre can reach")
    workspace_upper: Vector3 = quantity("m", "upper corner of the box that the hand's centre can reach")

    @classmethod
    def default_shape(cls, properties: Mapping[str, Any]) -> Shape | None:
        """Return the cylinder that the hand is."""
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

    radius: float = quantity(
        "m", "how far from its centre still counts as inside", gt=0, le=100, strict=True, allow_inf_nan=False
    )
