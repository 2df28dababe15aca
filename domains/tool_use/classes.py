"""Classes of hands, of tools, and of objects that hands push and strike with tools."""

from collections.abc import Mapping
from typing import ClassVar

from hybrid_tamp.authoring import (
    BODY_STATE,
    AffordanceClass,
    PointOnSurface,
    ShapeFeature,
    Token,
    VaryingProperty,
    Vector3,
    quantity,
)
from hybrid_tamp.skills import (
    BoxShaped,
    Extents,
    Graspable,
    Gripper,
    Grounded,
    find_box_fault,
    friction_property,
    mass_property,
    positive,
)

IMPULSE = VaryingProperty("impulse", 1, "N s", (0.0,), "largest impulse that the object has received so far")


class DexterousHand(Gripper):
    """A gripper that can swing a tool (paper, Sec. III-B)."""

    name: ClassVar[str] = "2-VIRTUAL-FINGERED HAND"

    strike_torque: float = positive("N m", "torque of a strike, in addition to the torque that bears the tool", 1e6)
    strike_angle: float = positive("rad", "angle through which strike_torque drives a strike", 2.5)

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Return an error message if the strike torque exceeds the wrist's maximal torque, otherwise None."""
        strike, most = token["strike_torque"], token["maximal_torque"]
        if strike > most:
            return f"strike_torque must be at most {most} N m, the maximal_torque; got {strike} N m"
        return Gripper.consistent(token)


class Striker(Graspable):
    """Tools that strike with a point of their head (paper, Fig. 5, red)."""

    name: ClassVar[str] = "STRIKER"
    of_shape: ClassVar[Mapping[str, ShapeFeature]] = {
        **Graspable.of_shape,
        "impact_point": PointOnSurface(),
    }

    impact_point: Vector3 = quantity("m", "striking point, in the body frame; a strike moves this point along -z")


class Pusher(Graspable):
    """Tools that push with a point of their head (paper, Fig. 5, green)."""

    name: ClassVar[str] = "PUSHER"
    of_shape: ClassVar[Mapping[str, ShapeFeature]] = {
        **Graspable.of_shape,
        "pushing_point": PointOnSurface(),
    }

    pushing_point: Vector3 = quantity("m", "pushing point, in the body frame; a push moves this point along +z")


class _Boxes(Grounded, BoxShaped):
    @staticmethod
    def consistent(token: Token) -> str | None:
        """Return an error message if the shape is not a box with the half extents, otherwise None."""
        return find_box_fault(token, "a PUSHABLE or STRIKABLE token must be a box; remove the token's shape")


class Strikable(_Boxes, AffordanceClass):
    """Objects that can be struck from above."""

    name: ClassVar[str] = "STRIKABLE"
    varying: ClassVar[tuple[VaryingProperty, ...]] = (*BODY_STATE, IMPULSE)

    half_extents: Extents = quantity("m", "half of each edge length along x, y and z")
    impulse_needed: float = positive("N s", "smallest impulse with which the object counts as struck", 1e6)


class Pushable(_Boxes, AffordanceClass):
    """Objects that can be pushed over the floor."""

    name: ClassVar[str] = "PUSHABLE"

    # Declared exactly as in STRIKABLE, so that a token may belong to both classes.
    half_extents: Extents = quantity("m", "half of each edge length along x, y and z")
    mass: float = mass_property()
    friction: float = friction_property()
