"""Object classes: affordance classes, capability classes and places (paper, Sec. II-A).

A class is a pydantic model of *fixed* properties. *Varying* state lives in arrays (`model.state`); a class
only names the varying properties of its members.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import permutations
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, Strict

from hybrid_tamp.geometry.shapes import Shape

Number = Annotated[float, Strict(), Field(allow_inf_nan=False)]
Vector3 = tuple[Number, Number, Number]


def _has_length(vector: Vector3) -> Vector3:
    length = math.hypot(*vector)
    if length < 1e-9:
        raise ValueError("a direction must not have length zero")
    if abs(length - 1.0) < 1e-15:
        return vector  # Another division could change the last bit between saving and loading.
    x, y, z = (component / length for component in vector)
    return (x, y, z)


Direction = Annotated[Vector3, AfterValidator(_has_length)]
"""A vector normalised to length one; length zero is refused."""


def quantity(unit: str, description: str, **constraints: Any) -> Any:
    """Declare a fixed property with its unit.

    Args:
        unit: SI unit, ``"1"`` for a pure number.
        description: one line for the schema and the reference page.
        **constraints: pydantic's field constraints and default (``gt=0``, ``default=0.5``, ...).
    """
    return Field(description=description, json_schema_extra={"unit": unit}, **constraints)


@dataclass(frozen=True)
class VaryingProperty:
    """A property that changes while blocks run, e.g. a position.

    Attributes:
        name: name within the token's state.
        size: number of components.
        unit: SI unit.
        default: value at rest, one number per component.
        description: one line.
    """

    name: str
    size: int
    unit: str
    default: tuple[float, ...]
    description: str = ""


POSITION = VaryingProperty("position", 3, "m", (0.0, 0.0, 0.0), "of the body's frame in the world")
ORIENTATION = VaryingProperty("orientation", 4, "1", (0.0, 0.0, 0.0, 1.0), "quaternion x, y, z, w")
VELOCITY = VaryingProperty("velocity", 3, "m/s", (0.0, 0.0, 0.0), "of the body's frame in the world")
ANGULAR_VELOCITY = VaryingProperty("angular_velocity", 3, "rad/s", (0.0, 0.0, 0.0), "in the world")
BODY_STATE = (POSITION, ORIENTATION, VELOCITY, ANGULAR_VELOCITY)


@dataclass(frozen=True)
class BasicAction:
    """An action that the robot commands directly on a capability token (paper, Sec. II-A).

    Attributes:
        name: e.g. ``"force"``.
        size: number of components of the command.
        unit: SI unit of the command.
        limit: property of the token that bounds the norm of the command, or None.
        description: one line.
    """

    name: str
    size: int
    unit: str
    limit: str | None = None
    description: str = ""


class ObjectClass(BaseModel):
    """A named set of fixed properties; the class of a slot (paper, Sec. II-A).

    Subclass `AffordanceClass`, `CapabilityClass` or `PlaceClass` and declare properties with `quantity`.

    Attributes:
        name: the class's own name, as task files write it, e.g. ``"STATIC END-EFFECTOR"``.
        varying: the varying properties that every member has.
        basic_actions: the actions that the robot commands directly; empty unless a capability class.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: ClassVar[str]
    varying: ClassVar[tuple[VaryingProperty, ...]] = BODY_STATE
    basic_actions: ClassVar[tuple[BasicAction, ...]] = ()

    @classmethod
    def default_shape(cls, properties: Mapping[str, Any]) -> Shape | None:
        """Return the shape that the properties imply for a token without one of its own, or None."""
        return None

    @classmethod
    def features(cls, shape: Shape) -> float:
        """Return how typical a shape is of the class, 0 to 1; it ranks classes for trials and proves nothing."""
        return 0.5

    @staticmethod
    def consistent(token: Any) -> str | None:
        """Return a message if the properties or the shape of a token contradict each other, else None."""
        return None

    @staticmethod
    def consistent_start(token: Any, state: Any, tokens: Any) -> str | None:
        """Return a message if the initial state of a token is inconsistent, else None.

        Args:
            token: the member of the class.
            state: the initial state, without batch dimensions.
            tokens: all tokens of the task.
        """
        return None

    @classmethod
    def describe(cls) -> str:
        """Return the first line of the class's docstring."""
        return (cls.__doc__ or "").strip().splitlines()[0] if cls.__doc__ else ""


class AffordanceClass(ObjectClass):
    """Properties relevant to one action that an object affords."""


class CapabilityClass(ObjectClass):
    """An affordance class that also has basic actions which the robot commands directly."""


class PlaceClass(ObjectClass):
    """A static place: a target that is never in a slot and never assigned."""


class TOKEN(ObjectClass):
    """The root class: every token that is not a place is a member."""

    name: ClassVar[str] = "TOKEN"


def is_place(object_class: type[ObjectClass]) -> bool:
    """Say whether members of the class are places."""
    return issubclass(object_class, PlaceClass)


class ClassRelations:
    """Which classes may have a token in common.

    Places and things are disjoint. Any two other classes may share a token unless the domain declares them disjoint.
    """

    def __init__(self, disjoint: Iterable[tuple[type[ObjectClass], ...]] = ()) -> None:
        """Take groups of classes whose members are pairwise disjoint."""
        self._groups = tuple(tuple(group) for group in disjoint)

    def can_share_token(self, one: type[ObjectClass], other: type[ObjectClass]) -> bool:
        """Say whether a token may be a member of both classes."""
        if one is other or issubclass(one, other) or issubclass(other, one):
            return True
        if is_place(one) != is_place(other):
            return False
        return not any(
            issubclass(one, mine) and issubclass(other, theirs)
            for group in self._groups
            for mine, theirs in permutations(group, 2)
        )
