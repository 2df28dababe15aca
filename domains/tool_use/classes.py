"""What grasps, what is grasped, what strikes and pushes, and what is struck and pushed."""

from collections.abc import Mapping
from typing import Any, ClassVar

from hybrid_tamp.authoring import (
    BODY_STATE,
    AffordanceClass,
    BasicAction,
    Box,
    Shape,
    Token,
    VaryingProperty,
    Vector3,
    aperture_property,
    quantity,
)

from ..common.classes import Extents, StaticEndEffector

_OPEN = 0.08
"""Gap between open fingers [m]."""
IMPULSE = VaryingProperty("impulse", 1, "N s", (0.0,), "hardest blow that it has taken so far")


class DexterousHand(StaticEndEffector):
    """A hand that can also open, close and turn its wrist (paper, Sec. III-B)."""

    name: ClassVar[str] = "2-VIRTUAL-FINGERED HAND"
    varying: ClassVar[tuple[VaryingProperty, ...]] = (*BODY_STATE, aperture_property(_OPEN))
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (
        *StaticEndEffector.basic_actions,
        BasicAction("torque", 3, "N m", "maximal_torque", "torque of the wrist in the world"),
        BasicAction("grip", 1, "N", "maximal_grip", "force of each finger: closes if positive, else opens"),
    )

    maximal_torque: float = quantity(
        "N m", "largest torque of the wrist", gt=0, le=1e6, strict=True, allow_inf_nan=False
    )
    maximal_grip: float = quantity(
        "N", "largest force of each virtual finger", gt=0, le=1e6, strict=True, allow_inf_nan=False
    )
    maximal_aperture: float = quantity(
        "m", "largest gap between the fingers", default=_OPEN, gt=0, le=1, strict=True, allow_inf_nan=False
    )
    wrist_inertia: float = quantity(
        "kg m^2", "moment of inertia of the hand about its wrist", gt=0, le=1e3, strict=True, allow_inf_nan=False
    )
    contact_width: float = quantity(
        "m", "length of a handle that the hand touches", gt=0, le=1, strict=True, allow_inf_nan=False
    )
    strike_torque: float = quantity(
        "N m", "torque that drives a strike, beyond what bears the tool", gt=0, le=1e6, strict=True, allow_inf_nan=False
    )
    strike_angle: float = quantity(
        "rad", "angle over which it drives the strike", gt=0, le=2.5, strict=True, allow_inf_nan=False
    )

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Complain about a strike that the wrist is too weak for."""
        if token["strike_torque"] > token["maximal_torque"]:
            return f"strike_torque is {token['strike_torque']} N m, more than the maximal_torque of the wrist"
        return StaticEndEffector.consistent(token)


class Graspable(AffordanceClass):
    """Has a handle along which a hand can grasp it (paper, Fig. 5, blue).

    Its body frame has its origin in the centre of mass; x goes along the handle towards the head, y is the axis about
    which it swings. Standing, its x axis looks down.
    """

    name: ClassVar[str] = "GRASPABLE"

    mass: float = quantity("kg", "mass", gt=0, le=1e6, strict=True, allow_inf_nan=False)
    friction: float = quantity("1", "Coulomb friction coefficient", ge=0, le=5, strict=True, allow_inf_nan=False)
    inertia: Extents = quantity("kg m^2", "principal moments of inertia about the body's axes")
    handle_from: Vector3 = quantity("m", "end of the graspable segment that is far from the head, in the body frame")
    handle_to: Vector3 = quantity("m", "end of the graspable segment that is near the head, in the body frame")
    handle_width: float = quantity("m", "width of the handle", gt=0, le=1, strict=True, allow_inf_nan=False)

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Complain about a handle without length, or one that does not lead along x towards the head."""
        start, end = token["handle_from"], token["handle_to"]
        if end[0] - start[0] < 1e-3:
            return "handle_to must lie further along x than handle_from: the body's x axis goes towards the head"
        if abs(end[1] - start[1]) > 1e-6 or abs(end[2] - start[2]) > 1e-6:
            return "handle_from and handle_to must differ in x only: the handle lies along the body's x axis"
        if token.shape is None:
            return "a tool needs a shape"
        return None


class Striker(Graspable):
    """A tool that strikes with a point of its head (paper, Fig. 5, red)."""

    name: ClassVar[str] = "STRIKER"

    impact_point: Vector3 = quantity("m", "point that strikes, in the body frame; it moves along -z")


class Pusher(Graspable):
    """A tool that pushes with a point of its head (paper, Fig. 5, green)."""

    name: ClassVar[str] = "PUSHER"

    pushing_point: Vector3 = quantity("m", "point that pushes, in the body frame; it moves along +z")


def _box_of_half_extents(token: Token) -> str | None:
    halves = token["half_extents"]
    if not isinstance(token.shape, Box):
        return "what tools push or strike is a box so far: remove the shape"
    if any(abs(one - other) > 0.01 * one for one, other in zip(halves, token.shape.half_extents, strict=True)):
        return f"half_extents are {halves} m, but those of its shape are {token.shape.half_extents} m"
    return None


class Strikable(AffordanceClass):
    """Can be struck from above."""

    name: ClassVar[str] = "STRIKABLE"
    varying: ClassVar[tuple[VaryingProperty, ...]] = (*BODY_STATE, IMPULSE)

    half_extents: Extents = quantity("m", "half of the edge lengths along x, y, z")
    impulse_needed: float = quantity(
        "N s", "blow from which on it counts as struck", gt=0, le=1e6, strict=True, allow_inf_nan=False
    )

    @classmethod
    def default_shape(cls, properties: Mapping[str, Any]) -> Shape | None:
        """Return the box of these half extents."""
        return Box(kind="box", half_extents=properties["half_extents"])

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Complain about a shape that is not the box of the half extents."""
        return _box_of_half_extents(token)


class Pushable(AffordanceClass):
    """Can be pushed over the floor."""

    name: ClassVar[str] = "PUSHABLE"

    # Declared exactly as in STRIKABLE, so that a token may be a member of both.
    half_extents: Extents = quantity("m", "half of the edge lengths along x, y, z")
    mass: float = quantity("kg", "mass", gt=0, le=1e6, strict=True, allow_inf_nan=False)
    friction: float = quantity("1", "Coulomb friction coefficient", ge=0, le=5, strict=True, allow_inf_nan=False)

    @classmethod
    def default_shape(cls, properties: Mapping[str, Any]) -> Shape | None:
        """Return the box of these half extents."""
        return Box(kind="box", half_extents=properties["half_extents"])

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Complain about a shape that is not the box of the half extents."""
        return _box_of_half_extents(token)
