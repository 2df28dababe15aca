"""Hands that can grip, and objects with a handle."""

from collections.abc import Mapping
from typing import ClassVar

from hybrid_tamp.geometry.agreement import MomentsOfInertia, PointWithin, ShapeFeature
from hybrid_tamp.model.affordance import BODY_STATE, AffordanceClass, BasicAction, VaryingProperty, Vector3, quantity
from hybrid_tamp.model.grasp import HANDLE_FRICTION, PAD_FRICTION, aperture_property
from hybrid_tamp.model.token import Token
from hybrid_tamp.skills.classes import (
    Extents,
    Grounded,
    TurningEndEffector,
    friction_property,
    mass_property,
    not_negative,
    positive,
)

_OPEN = 0.08
"""Gap between open fingers [m]."""


class Gripper(TurningEndEffector):
    """A hand with two virtual fingers that open and close, and with a wrist that turns (paper, Sec. III-B)."""

    name: ClassVar[str] = "GRIPPER"
    varying: ClassVar[tuple[VaryingProperty, ...]] = (*BODY_STATE, aperture_property(_OPEN))
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (
        *TurningEndEffector.basic_actions,
        BasicAction("grip", 1, "N", "maximal_grip", "force of each finger; positive values close the hand"),
    )

    maximal_grip: float = positive("N", "largest force of each virtual finger", 1e6)
    maximal_aperture: float = positive("m", "largest gap between the fingers", 1, default=_OPEN)
    contact_width: float = positive("m", "length of the hand's contact with a handle, along the handle", 1)
    pad_friction: float = not_negative("1", "friction coefficient of the fingers' pads", 5, default=PAD_FRICTION)


class Graspable(Grounded, AffordanceClass):
    """Objects with a handle that a hand can grasp (paper, Fig. 5, blue).

    The origin of the body frame is the centre of mass. The x axis points along the handle, and down if the object
    stands. A tool stands on its head, so its x axis points towards the head. The fingers close along the z axis.
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
    handle_from: Vector3 = quantity("m", "end of the graspable segment that is up if the object stands, body frame")
    handle_to: Vector3 = quantity("m", "end of the graspable segment that is down if the object stands, body frame")
    handle_width: float = positive("m", "width of the handle", 1)
    handle_friction: float = not_negative(
        "1", "friction coefficient of the handle; multiplied by the pads' coefficient", 5, default=HANDLE_FRICTION
    )

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Return an error message if the handle does not extend along the x axis, otherwise None."""
        start, end = token["handle_from"], token["handle_to"]
        if end[0] - start[0] < 1e-3:
            return (
                "handle_to must have a larger x than handle_from, so that the x axis points down if the object stands"
            )
        if abs(end[1] - start[1]) > 1e-6 or abs(end[2] - start[2]) > 1e-6:
            return "handle_from and handle_to must have the same y and z, because the handle lies along the x axis"
        return "an object with a handle must have a shape" if token.shape is None else None
