"""Classes of hands, of tools, and of objects that hands push and strike with tools."""

from collections.abc import Mapping
from typing import ClassVar

from hybrid_tamp.authoring import (
    BODY_STATE,
    HANDLE_FRICTION,
    PAD_FRICTION,
    AffordanceClass,
    BasicAction,
    MomentsOfInertia,
    PointOnSurface,
    PointWithin,
    ShapeFeature,
    Token,
    VaryingProperty,
    Vector3,
    aperture_property,
    quantity,
)
from hybrid_tamp.skills import (
    BoxShaped,
    Extents,
    Grounded,
    StaticEndEffector,
    find_box_fault,
    friction_property,
    mass_property,
    not_negative,
    positive,
)

_OPEN = 0.08
"""Gap between open fingers [m]."""
IMPULSE = VaryingProperty("impulse", 1, "N s", (0.0,), "largest impulse that the object has received so far")


class DexterousHand(StaticEndEffector):
    """A hand with two virtual fingers that open and close, and with a wrist that turns (paper, Sec. III-B)."""

    name: ClassVar[str] = "2-VIRTUAL-FINGERED HAND"
    varying: ClassVar[tuple[VaryingProperty, ...]] = (*BODY_STATE, aperture_property(_OPEN))
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (
        *StaticEndEffector.basic_actions,
        BasicAction("torque", 3, "N m", "maximal_torque", "torque of the wrist in the world frame"),
        BasicAction("grip", 1, "N", "maximal_grip", "force of each finger; positive values close the hand"),
    )

    maximal_torque: float = positive("N m", "largest torque of the wrist", 1e6)
    maximal_grip: float = positive("N", "largest force of each virtual finger", 1e6)
    maximal_aperture: float = positive("m", "largest gap between the fingers", 1, default=_OPEN)
    wrist_inertia: float = positive("kg m^2", "moment of inertia of the hand about its wrist", 1e3)
    contact_width: float = positive("m", "length of the hand's contact with a handle, along the handle", 1)
    pad_friction: float = not_negative("1", "friction coefficient of the fingers' pads", 5, default=PAD_FRICTION)
    strike_torque: float = positive("N m", "torque of a strike, in addition to the torque that bears the tool", 1e6)
    strike_angle: float = positive("rad", "angle through which strike_torque drives a strike", 2.5)

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Return an error message if the strike torque exceeds the wrist's maximal torque, otherwise None."""
        strike, most = token["strike_torque"], token["maximal_torque"]
        if strike > most:
            return f"strike_torque must be at most {most} N m, the maximal_torque; got {strike} N m"
        return StaticEndEffector.consistent(token)


class Graspable(Grounded, AffordanceClass):
    """Tools with a handle that a hand can grasp (paper, Fig. 5, blue).

    The origin of the body frame is the centre of mass. The x axis points along the handle towards the head. The tool
    swings about the y axis. A tool stands on its head, with x pointing down.
    """

    name: ClassVar[str] = "GRASPABLE"
    of_shape: ClassVar[Mapping[str, ShapeFeature]] = {
        "inertia": MomentsOfInertia(),
        "handle_from": PointWithin(),
        "handle_to": PointWithin(),
    }

    mass: float = mass_property()
    friction: float = friction_property()
    inertia: Extents = quantity("kg m^2", "principal moments of inertia about the body's axes")
    handle_from: Vector3 = quantity("m", "far end of the graspable segment, away from the head, in the body frame")
    handle_to: Vector3 = quantity("m", "near end of the graspable segment, next to the head, in the body frame")
    handle_width: float = positive("m", "width of the handle", 1)
    handle_friction: float = not_negative(
        "1", "friction coefficient of the handle; multiplied by the pads' coefficient", 5, default=HANDLE_FRICTION
    )

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Return an error message if the handle does not extend along x towards the head, otherwise None."""
        start, end = token["handle_from"], token["handle_to"]
        if end[0] - start[0] < 1e-3:
            return "handle_to must have a larger x than handle_from, because the x axis points towards the head"
        if abs(end[1] - start[1]) > 1e-6 or abs(end[2] - start[2]) > 1e-6:
            return "handle_from and handle_to must have the same y and z, because the handle lies along the x axis"
        if token.shape is None:
            return "a tool must have a shape"
        return None


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
