"""Object tokens, whose properties are the union of the properties of their classes (paper, Sec. II-A)."""

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any

from hybrid_tamp.errors import did_you_mean
from hybrid_tamp.geometry.convex import reach_of
from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.model.affordance import TOKEN, BasicAction, ObjectClass, VaryingProperty, is_place
from hybrid_tamp.model.ground import ON_FLOOR, Ground
from hybrid_tamp.model.union import sort_classes, union_of


class UnknownProperty(KeyError):
    """Error for a property that a token does not have. The message lists the properties of the token."""

    def __init__(self, token: str, name: object, available: Iterable[str]) -> None:
        super().__init__(token, name)
        known = tuple(sorted(available))
        close = did_you_mean(str(name), known)
        hint = f"did you mean {close!r}?" if close else f"available: {', '.join(known)}"
        self._message = f"{token} has no property {name!r}; {hint}"

    def __str__(self) -> str:
        return self._message


class UnknownToken(UnknownProperty):
    """Error for a token that a state does not contain, e.g. because the block of a policy does not use the token."""

    def __init__(self, token: str, name: object, available: Iterable[str]) -> None:
        super().__init__(token, name, ())
        known = ", ".join(available) or "no token"
        self._message = f"{token} has no property {name!r} in this state, which contains only {known}"


class UnknownTarget(UnknownToken):
    """Error for a new value for a token that a state does not contain."""


@dataclass(frozen=True, eq=False)
class Token:
    """One object of the scene: a thing, a part of a robot, or a place.

    Attributes:
        name: name that the user gave the token.
        classes: object classes of the token, sorted by name. All tokens except places also have the root class TOKEN.
        properties: maps the name of each fixed property to its value.
        shape: geometry of the token, or None if the token has no shape.
        unknown: classes of which the token may or may not be a member.
        immovable: whether the token is a body that nothing can move, e.g. a wall. Only members of `TOKEN` that have no
            other class can be immovable.
        ground: what the token rests on at the start (see `model.support.with_grounds`).
        burden: names of the movable bodies that rest on the token at the start.
    """

    name: str
    classes: tuple[type[ObjectClass], ...]
    properties: Mapping[str, Any]
    shape: Shape | None = None
    unknown: tuple[type[ObjectClass], ...] = ()
    immovable: bool = False
    ground: Ground = ON_FLOOR
    burden: tuple[str, ...] = ()

    @classmethod
    def make(
        cls,
        name: str,
        classes: Iterable[type[ObjectClass]],
        properties: Mapping[str, Any],
        shape: Shape | None = None,
        unknown: Iterable[type[ObjectClass]] = (),
        immovable: bool = False,
    ) -> "Token":
        """Validate the properties and return a token. Properties of `unknown` classes may be missing.

        Raises:
            PropertyConflictError: if two classes declare the same property differently.
            pydantic.ValidationError: if a property is missing, unknown, of a wrong type or out of bounds.
        """
        members = sort_classes(classes)
        if not any(is_place(member) for member in members):
            members = sort_classes((*members, TOKEN))
        doubtful = sort_classes(unknown)
        given = dict(union_of(members, doubtful).model_validate(dict(properties)))
        values = MappingProxyType({key: value for key, value in given.items() if value is not None})
        implied = (member.default_shape(values) for member in members)
        solid = shape or next((s for s in implied if s is not None), None)
        return cls(name, members, values, solid, doubtful, immovable)

    def __getitem__(self, property_name: str) -> Any:
        """Return the value of a fixed property. Raise a `KeyError` if the token does not have the property."""
        try:
            return self.properties[property_name]
        except KeyError:
            raise UnknownProperty(self.name, property_name, self.properties) from None

    def __repr__(self) -> str:
        return f"Token({self.name!r}: {', '.join(member.name for member in self.classes)})"

    @property
    def solid(self) -> Shape:
        """Shape of the token.

        Raises:
            UnknownProperty: if the token has no shape.
        """
        if self.shape is None:
            raise UnknownProperty(self.name, "shape", self.properties)
        return self.shape

    def is_member(self, object_class: type[ObjectClass]) -> bool:
        """Return whether the token is a member of the class."""
        return any(issubclass(member, object_class) for member in self.classes)

    def may_be_member(self, object_class: type[ObjectClass]) -> bool:
        """Return whether the token's membership of the class is unknown."""
        return not self.is_member(object_class) and any(issubclass(each, object_class) for each in self.unknown)

    @cached_property
    def fixed(self) -> Hashable:
        """Comparison key. Tokens with the same classes, properties, shape, ground and burden have equal keys."""
        properties = tuple(sorted(self.properties.items()))
        key = (self.classes, properties, self.shape, self.immovable, self.ground, self.burden)
        try:
            hash(key)
            return key
        except TypeError:
            return self.name

    @cached_property
    def reach(self) -> float:
        """Radius of the ball around the origin of the body frame that contains the token [m]."""
        return reach_of(self.solid)

    @property
    def place(self) -> bool:
        """Whether the token is a place. A place can be a target, but is never in a slot."""
        return any(is_place(member) for member in self.classes)

    @property
    def bystander(self) -> bool:
        """Whether the token has no class except `TOKEN`, so that no block can use it."""
        return self.classes == (TOKEN,) and not self.unknown

    @property
    def fixed_body(self) -> bool:
        """Whether the token is a body that nothing can move, e.g. a table."""
        return self.immovable or (self.place and self.shape is not None)

    @property
    def varying(self) -> tuple[VaryingProperty, ...]:
        """Varying properties of the token's classes, without duplicates."""
        merged = {varying.name: varying for member in self.classes for varying in member.varying}
        return tuple(merged.values())

    @cached_property
    def basic_actions(self) -> tuple[BasicAction, ...]:
        """Basic actions of the token's capability classes, without duplicates, sorted by name."""
        merged = {action.name: action for member in self.classes for action in member.basic_actions}
        return tuple(merged[name] for name in sorted(merged))


def different(values: Iterable[object]) -> bool:
    """Return whether no token occurs twice among the values. Symbols may repeat."""
    names = [value.name for value in values if isinstance(value, Token)]
    return len(set(names)) == len(names)
