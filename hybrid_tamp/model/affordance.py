"""Object classes: affordance classes, capability classes and places (paper, Sec. II-A).

A class is a pydantic model of *fixed* properties. A class also declares the *varying* properties of its members. The
values of varying properties are stored in arrays (see `model.state`).
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import permutations
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, Strict

from hybrid_tamp.geometry.agreement import ShapeFeature
from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.motion.constants import DEFAULT_FRICTION, DEFAULT_MASS

Number = Annotated[float, Strict(), Field(allow_inf_nan=False)]
Vector3 = tuple[Number, Number, Number]
"""Three finite numbers, e.g. along the x, y and z axes."""


def _has_length(vector: Vector3) -> Vector3:
    length = math.hypot(*vector)
    if length < 1e-9:
        raise ValueError("a direction must not be a vector of length zero")
    if abs(length - 1.0) < 1e-15:
        return vector  # Another division could change the last bit of a saved vector.
    x, y, z = (component / length for component in vector)
    return (x, y, z)


Direction = Annotated[Vector3, AfterValidator(_has_length)]
"""Vector that is normalised to length one. A vector of length zero is an error."""


def quantity(unit: str, description: str, **constraints: Any) -> Any:
    """Return the pydantic field of a fixed property with a unit.

    Args:
        unit: SI unit, or ``"1"`` for a dimensionless number.
        description: description in one line, for the JSON schema and the reference page.
        **constraints: further arguments of `pydantic.Field`, e.g. ``gt=0`` or ``default=0.5``.
    """
    return Field(description=description, json_schema_extra={"unit": unit}, **constraints)


@dataclass(frozen=True)
class VaryingProperty:
    """A property that changes while blocks run, e.g. a position.

    Attributes:
        name: name of the property in the state of a token.
        size: number of components.
        unit: SI unit.
        default: initial value if the task gives no value. One number per component.
        description: description in one line.
    """

    name: str
    size: int
    unit: str
    default: tuple[float, ...]
    description: str = ""


POSITION = VaryingProperty("position", 3, "m", (0.0, 0.0, 0.0), "position of the body frame in the world")
ORIENTATION = VaryingProperty("orientation", 4, "1", (0.0, 0.0, 0.0, 1.0), "orientation as a quaternion (x, y, z, w)")
VELOCITY = VaryingProperty("velocity", 3, "m/s", (0.0, 0.0, 0.0), "velocity of the body frame in the world")
ANGULAR_VELOCITY = VaryingProperty("angular_velocity", 3, "rad/s", (0.0, 0.0, 0.0), "angular velocity in the world")
BODY_STATE = (POSITION, ORIENTATION, VELOCITY, ANGULAR_VELOCITY)
"""Varying properties of a rigid body: pose (m, quaternion x, y, z, w), velocity [m/s], angular velocity [rad/s]."""


@dataclass(frozen=True)
class BasicAction:
    """An action that the robot commands directly (paper, Sec. II-A). Only capability tokens have basic actions.

    Attributes:
        name: name of the action, e.g. ``"force"``.
        size: number of components of the command.
        unit: SI unit of the command.
        limit: name of the fixed property whose value limits the norm of the command, or None.
        description: description in one line.
    """

    name: str
    size: int
    unit: str
    limit: str | None = None
    description: str = ""


class ObjectClass(BaseModel):
    """A named set of fixed properties. A slot admits only members of its class (paper, Sec. II-A).

    To define a class, subclass `AffordanceClass`, `CapabilityClass` or `PlaceClass`. Use `quantity` for properties.

    Attributes:
        name: name of the class in task files, e.g. ``"STATIC END-EFFECTOR"``.
        varying: varying properties of every member.
        basic_actions: actions that the robot commands directly. Only capability classes have basic actions.
        of_shape: maps each property that describes the shape of the token to the feature that it must equal. A task
            file in which property and shape disagree is refused with both figures.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: ClassVar[str]
    varying: ClassVar[tuple[VaryingProperty, ...]] = BODY_STATE
    basic_actions: ClassVar[tuple[BasicAction, ...]] = ()
    of_shape: ClassVar[Mapping[str, ShapeFeature]] = {}

    @classmethod
    def default_shape(cls, properties: Mapping[str, Any]) -> Shape | None:
        """Return the shape implied by the properties, or None. A token without a shape in the task gets this shape."""
        return None

    @classmethod
    def features(cls, shape: Shape) -> float:
        """Return a score from 0 to 1 for how typical a shape is of the class. The score only serves to rank classes."""
        return 0.5

    @staticmethod
    def consistent(token: Any) -> str | None:
        """Return a message if the properties and the shape of a token contradict each other, else None."""
        return None

    @staticmethod
    def consistent_start(token: Any, state: Any, tokens: Any) -> str | None:
        """Return a message if the initial state of a token is inconsistent, else None.

        Args:
            token: a member of the class.
            state: initial state of the task, without batch dimensions.
            tokens: all tokens of the task.
        """
        return None

    @classmethod
    def describe(cls) -> str:
        """Return the first line of the class's docstring."""
        return (cls.__doc__ or "").strip().splitlines()[0] if cls.__doc__ else ""


class AffordanceClass(ObjectClass):
    """A class of objects that afford one action. The class has the properties that matter for this action."""


class CapabilityClass(ObjectClass):
    """A class whose members have basic actions, which the robot commands directly."""


class PlaceClass(ObjectClass):
    """A class of static places. A place can be a target, but never fills a slot. With a shape, it is a fixed body."""


class TOKEN(ObjectClass):
    """The root class, whose members are all tokens except places."""

    name: ClassVar[str] = "TOKEN"


class BystanderProperties(BaseModel):
    """Properties of a token that is a member of `TOKEN` only, e.g. a crate that no block can move."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    mass: Annotated[Number, Field(gt=0, le=1e6)] = quantity("kg", "mass of the body", default=DEFAULT_MASS)
    friction: Annotated[Number, Field(ge=0, le=100)] = quantity("1", "friction coefficient", default=DEFAULT_FRICTION)


def is_place(object_class: type[ObjectClass]) -> bool:
    """Return whether the members of the class are places."""
    return issubclass(object_class, PlaceClass)


def _is_driven(one: type[ObjectClass], other: type[ObjectClass]) -> bool:
    """Return whether one class is a capability class and the other one is an affordance class."""
    kinds = (CapabilityClass, AffordanceClass)
    return any(issubclass(one, kind) and issubclass(other, another) for kind, another in permutations(kinds))


class ClassRelations:
    """Rules that determine whether two classes can have a common member.

    Two rules follow from what the classes are: a class of places and a class of other tokens are disjoint, and so are a
    capability class, whose members the robot drives, and an affordance class. A domain can declare further classes as
    disjoint.
    """

    def __init__(self, disjoint: Iterable[tuple[type[ObjectClass], ...]] = ()) -> None:
        """Create the rules from groups of pairwise disjoint classes."""
        self._groups = tuple(tuple(group) for group in disjoint)

    def can_share_token(self, one: type[ObjectClass], other: type[ObjectClass]) -> bool:
        """Return whether a token can be a member of both classes."""
        if one is other or issubclass(one, other) or issubclass(other, one):
            return True
        if is_place(one) != is_place(other):
            return False
        if _is_driven(one, other):
            return False
        return not any(
            issubclass(one, mine) and issubclass(other, theirs)
            for group in self._groups
            for mine, theirs in permutations(group, 2)
        )
