"""Object classes and property declarations that several domains share."""

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import AfterValidator

from hybrid_tamp.geometry.agreement import CylinderSize, HalfExtents, ShapeFeature
from hybrid_tamp.geometry.shapes import Box, Cylinder, Shape
from hybrid_tamp.model.affordance import AffordanceClass, BasicAction, CapabilityClass, PlaceClass, Vector3, quantity
from hybrid_tamp.model.default_system import has_wrist
from hybrid_tamp.model.laying import find_unlaid
from hybrid_tamp.model.margins import without_rounding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.support import find_floating
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import rotate
from hybrid_tamp.skills.vectors import UP, depth_in_workspace

_MOST_TILTED = np.radians(3.0)
"""Largest angle between the axis of a region or surface and the vertical [rad]."""


def _all_positive(vector: Vector3) -> Vector3:
    if min(vector) <= 0:
        raise ValueError("all three components must be greater than 0")
    return vector


Extents = Annotated[Vector3, AfterValidator(_all_positive)]
"""Half of each edge length of a box, along the body's x, y and z axes [m]."""


def positive(unit: str, description: str, most: float, **default: float) -> Any:
    """Declare a property that must be finite, greater than 0 and at most `most`."""
    return quantity(unit, description, **default, gt=0, le=most, strict=True, allow_inf_nan=False)


def not_negative(unit: str, description: str, most: float, **default: float) -> Any:
    """Declare a property that must be finite and between 0 and `most`."""
    return quantity(unit, description, **default, ge=0, le=most, strict=True, allow_inf_nan=False)


# A token may belong to two classes only if the classes declare their common properties identically.
def mass_property() -> Any:
    """Declare the mass of a body."""
    return positive("kg", "mass", 1e6)


def friction_property() -> Any:
    """Declare the friction coefficient of a body."""
    return not_negative("1", "Coulomb friction coefficient", 5)


class BoxShaped:
    """Mixin for a class whose tokens are boxes by default. The property `half_extents` gives the size of the box."""

    of_shape: ClassVar[Mapping[str, ShapeFeature]] = {"half_extents": HalfExtents()}

    @classmethod
    def default_shape(cls, properties: Mapping[str, Any]) -> Shape | None:
        """Return the box with the half extents in `properties`."""
        return Box(kind="box", half_extents=properties["half_extents"])


def find_box_fault(token: Token, other_shape: str) -> str | None:
    """Return the error message `other_shape` if a token's shape is not a box, otherwise None."""
    return None if isinstance(token.shape, Box) else other_shape


class StaticEndEffector(CapabilityClass):
    """A hand that can push objects but cannot grasp them (paper, Sec. II-A)."""

    name: ClassVar[str] = "STATIC END-EFFECTOR"
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (
        BasicAction("force", 3, "N", "maximal_force", "force in the world frame, in addition to gravity compensation"),
    )

    of_shape: ClassVar[Mapping[str, ShapeFeature]] = {
        "radius": CylinderSize("radius"),
        "length": CylinderSize("length"),
    }

    radius: float = positive("m", "radius of the cylindrical hand", 10)
    length: float = positive("m", "length of the cylindrical hand", 10)
    mass: float = mass_property()
    maximal_force: float = positive("N", "largest force that the hand can exert", 1e7)
    workspace_lower: Vector3 = quantity("m", "lower corner of the box in which the hand's centre must stay")
    workspace_upper: Vector3 = quantity("m", "upper corner of the box in which the hand's centre must stay")

    @classmethod
    def default_shape(cls, properties: Mapping[str, Any]) -> Shape | None:
        """Return a cylinder with the hand's radius and length."""
        return Cylinder(kind="cylinder", radius=properties["radius"], length=properties["length"])

    @staticmethod
    def consistent(token: Token) -> str | None:
        """Return an error message if the corners of the workspace are in the wrong order, otherwise None."""
        lower, upper = token["workspace_lower"], token["workspace_upper"]
        if any(low >= high for low, high in zip(lower, upper, strict=True)):
            return f"workspace_lower must be less than workspace_upper in x, y and z; got {lower} m and {upper} m"
        return None

    @staticmethod
    def consistent_start(token: Token, state: State, tokens: Iterable[Token]) -> str | None:
        """Return an error message if the hand starts outside its workspace, otherwise None."""
        depth = float(without_rounding(depth_in_workspace(token, state[token, "position"]), 1.0))
        return None if depth >= 0 else f"the hand must start within its workspace, but it is {-depth:.4g} m outside"


class TurningEndEffector(StaticEndEffector):
    """A hand that can push objects and turn about all axes, with a limited torque, but cannot grasp objects."""

    name: ClassVar[str] = "TURNING END-EFFECTOR"
    basic_actions: ClassVar[tuple[BasicAction, ...]] = (
        *StaticEndEffector.basic_actions,
        BasicAction("torque", 3, "N m", "maximal_torque", "torque of the wrist in the world frame"),
    )

    maximal_torque: float = positive("N m", "largest torque of the wrist", 1e6)
    wrist_inertia: float = positive("kg m^2", "moment of inertia of the hand about its wrist", 1e3)


def can_turn(hand: Token) -> bool:
    """Return whether a hand has a wrist, i.e. a basic action with which the hand turns."""
    return has_wrist(hand)


class Grounded:
    """Mixin for a class whose members rest on the floor or on another body at the start."""

    @staticmethod
    def consistent_start(token: Token, state: State, tokens: Iterable[Token]) -> str | None:
        """Return an error message if the body starts in the air, otherwise None."""
        return find_floating(token, state, tokens)


class Body(Grounded, AffordanceClass):
    """Base of classes of rigid bodies with a mass and a friction coefficient, which rest on something at the start."""

    mass: float = mass_property()
    friction: float = friction_property()


class Surface(PlaceClass):
    """A fixed body with a level top, e.g. a table. Objects can lie on it."""

    name: ClassVar[str] = "SURFACE"

    friction: float = friction_property()

    @staticmethod
    def consistent_start(token: Token, state: State, tokens: Iterable[Token]) -> str | None:
        """Return an error message if the surface is not level, otherwise None."""
        return _find_tilt(token, state)


class Container(Surface):
    """A fixed body that is open at its top, e.g. a tray. Objects can lie in it."""

    name: ClassVar[str] = "CONTAINER"


class Region(PlaceClass):
    """A level disc on the floor or on a fixed body, which can be the destination of an object."""

    name: ClassVar[str] = "REGION"

    radius: float = positive("m", "radius of the disc; an object is inside if its centre is above the disc", 100)

    @staticmethod
    def consistent_start(token: Token, state: State, tokens: Iterable[Token]) -> str | None:
        """Return an error message if the disc is not level or lies on nothing that is fixed, otherwise None."""
        return find_unlaid(token, token["radius"], state, tokens) or _find_tilt(token, state)


def _find_tilt(token: Token, state: State) -> str | None:
    """Return an error message if the z axis of a token is not vertical, otherwise None."""
    tilt = np.arccos(np.clip(rotate(state[token, "orientation"], UP)[2], -1.0, 1.0))
    if tilt <= _MOST_TILTED:
        return None
    limit = f"{np.degrees(_MOST_TILTED):.0f} degrees"
    kind = next(each.name for each in token.classes if issubclass(each, Region | Surface))
    return f"a {kind} must be level within {limit}; it is tilted by {np.degrees(tilt):.3g} degrees"
