"""What rolls."""

from typing import ClassVar

from hybrid_tamp.model.affordance import AffordanceClass, Direction, quantity
from hybrid_tamp.model.shape import Box, Cylinder
from hybrid_tamp.model.token import Token


class Rollable(AffordanceClass):
    """Can be rolled about an axis (paper, Sec. II-A)."""

    name: ClassVar[str] = "ROLLABLE"

    axis_of_rotation: Direction = quantity("1", "axis of rotation in the body frame")
    radius_of_rotation: float = quantity("m", "radius on which it rolls", gt=0, le=10, strict=True, allow_inf_nan=False)
    mass: float = quantity("kg", "mass", gt=0, strict=True, allow_inf_nan=False)
    friction: float = quantity("1", "Coulomb friction coefficient", ge=0, le=5, strict=True, allow_inf_nan=False)
    rolling_friction: float = quantity(
        "m",
        "rolling friction: torque per normal force",
        default=0.005,
        ge=0,
        le=1,
        strict=True,
        allow_inf_nan=False,
    )

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Complain about a shape that contradicts the radius of rotation."""
        radius = token["radius_of_rotation"]
        if isinstance(token.shape, Cylinder) and abs(token.shape.radius - radius) > 0.01 * radius:
            return f"radius_of_rotation is {radius} m, but the radius of its shape is {token.shape.radius} m"
        if isinstance(token.shape, Box):
            return "a box does not roll: give it another shape, or do not make it a member of ROLLABLE"
        return None
