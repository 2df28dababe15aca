"""Object tokens, whose properties are the union of the properties of their classes (paper, Sec. II-A).

If two classes declare the same property, the token has that property once. Multiple inheritance in pydantic would
merge conflicting declarations silently. `union_of` raises an error for them, in any order of the classes.
"""

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from types import MappingProxyType
from typing import Any, get_args

from pydantic import BaseModel, ConfigDict, create_model
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from hybrid_tamp.errors import Issue, did_you_mean
from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.model.affordance import TOKEN, BasicAction, ObjectClass, VaryingProperty, is_place


class PropertyConflictError(ValueError):
    """Error for classes that declare the same property differently. `issues` has one entry for each difference."""

    def __init__(self, issues: Iterable[Issue]) -> None:
        self.issues = tuple(issues)
        super().__init__("\n".join(map(str, self.issues)))


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


def _declarations(object_class: type[ObjectClass]) -> dict[str, dict[str, str]]:
    """Return the content of each declaration of a class. Classes that share a declaration must agree on its content."""
    found = {f"property {name!r}": _describe(field) for name, field in object_class.model_fields.items()}
    for varying in object_class.varying:
        described = {"size": str(varying.size), "unit": varying.unit, "default": str(varying.default)}
        found[f"varying property {varying.name!r}"] = described
    for action in object_class.basic_actions:
        described = {"size": str(action.size), "unit": action.unit, "limit": str(action.limit)}
        found[f"basic action {action.name!r}"] = described
    return found


def _describe(field: FieldInfo) -> dict[str, str]:
    extra, kind = field.json_schema_extra, field.annotation
    return {
        "type": kind.__name__ if isinstance(kind, type) and not get_args(kind) else str(kind),
        "bounds": ", ".join(sorted(str(item) for item in field.metadata)) or "none",
        "unit": str(extra.get("unit", "1")) if isinstance(extra, dict) else "1",
        "default": "none" if field.default is PydanticUndefined else repr(field.default),
    }


def conflicts(classes: Iterable[type[ObjectClass]]) -> list[Issue]:
    """Return one issue for each difference between declarations of the same name in two of the classes."""
    seen: dict[str, tuple[type[ObjectClass], dict[str, str]]] = {}
    found = []
    for object_class in _ordered(classes):
        for what, mine in _declarations(object_class).items():
            owner, theirs = seen.setdefault(what, (object_class, mine))
            for key in (key for key in mine if mine[key] != theirs[key]):
                found.append(
                    Issue(
                        where=f"{owner.name} and {object_class.name}",
                        wanted=f"both classes must declare the same {key} for {what}",
                        came=f"{theirs[key]} in {owner.name} and {mine[key]} in {object_class.name}",
                        remedy=_remedy(what, owner, object_class),
                    )
                )
    return found


def _remedy(what: str, one: type[ObjectClass], other: type[ObjectClass]) -> str:
    rename = f"rename {what} in one of the classes"
    if issubclass(one, other) or issubclass(other, one):
        return rename
    pair = f"disjoint=(({one.__name__}, {other.__name__}),)"
    return f"{rename}, or, if no token is a member of both, declare the classes disjoint in the domain: {pair}"


def _ordered(classes: Iterable[type[ObjectClass]]) -> tuple[type[ObjectClass], ...]:
    return tuple(sorted(set(classes), key=lambda object_class: object_class.name))


def union_of(classes: Iterable[type[ObjectClass]], unknown: Iterable[type[ObjectClass]] = ()) -> type[BaseModel]:
    """Return the pydantic model whose fields are the union of the classes' properties.

    Args:
        classes: object classes, in any order.
        unknown: classes of which the token may be a member. Properties that only these classes declare may be missing.

    Raises:
        PropertyConflictError: if two classes declare the same property with different types, units, bounds or defaults.
    """
    return _union(_ordered(classes), _ordered(unknown))


@lru_cache(maxsize=1024)
def _union(classes: tuple[type[ObjectClass], ...], unknown: tuple[type[ObjectClass], ...]) -> type[BaseModel]:
    faults = conflicts((*classes, *unknown))
    if faults:
        raise PropertyConflictError(faults)
    fields: dict[str, Any] = {}
    for object_class in classes:
        for name, field in object_class.model_fields.items():
            fields.setdefault(name, (field.annotation, field))
    for object_class in unknown:
        for name, field in object_class.model_fields.items():
            # None marks a missing property, because None is never a valid value.
            fields.setdefault(name, (field.annotation, FieldInfo.merge_field_infos(field, default=None)))
    return create_model(
        " + ".join(object_class.name for object_class in classes) or "no class",
        __config__=ConfigDict(extra="forbid", frozen=True),
        **{name: fields[name] for name in sorted(fields)},
    )


@dataclass(frozen=True, eq=False)
class Token:
    """One object of the scene: a thing, a part of a robot, or a place.

    Attributes:
        name: name that the user gave the token.
        classes: object classes of the token, sorted by name. All tokens except places also have the root class TOKEN.
        properties: maps the name of each fixed property to its value.
        shape: geometry of the token, or None if the token has no shape.
        unknown: classes of which the token may or may not be a member.
    """

    name: str
    classes: tuple[type[ObjectClass], ...]
    properties: Mapping[str, Any]
    shape: Shape | None = None
    unknown: tuple[type[ObjectClass], ...] = ()

    @classmethod
    def make(
        cls,
        name: str,
        classes: Iterable[type[ObjectClass]],
        properties: Mapping[str, Any],
        shape: Shape | None = None,
        unknown: Iterable[type[ObjectClass]] = (),
    ) -> "Token":
        """Validate the properties and return a token. Properties of `unknown` classes may be missing.

        Raises:
            PropertyConflictError: if two classes declare the same property differently.
            pydantic.ValidationError: if a property is missing, unknown, of a wrong type or out of bounds.
        """
        members = _ordered(classes)
        if not any(is_place(member) for member in members):
            members = _ordered((*members, TOKEN))
        doubtful = _ordered(unknown)
        given = dict(union_of(members, doubtful).model_validate(dict(properties)))
        values = MappingProxyType({key: value for key, value in given.items() if value is not None})
        implied = (member.default_shape(values) for member in members)
        return cls(name, members, values, shape or next((s for s in implied if s is not None), None), doubtful)

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
        """Comparison key. Tokens with the same classes, properties and shape have equal keys."""
        key = (self.classes, tuple(sorted(self.properties.items())), self.shape)
        try:
            hash(key)
            return key
        except TypeError:
            return self.name

    @property
    def place(self) -> bool:
        """Whether the token is a place. A place can be a target, but is never in a slot."""
        return any(is_place(member) for member in self.classes)

    @property
    def fixed_body(self) -> bool:
        """Whether the token is a body that nothing can move, e.g. a table."""
        return self.place and self.shape is not None

    @property
    def varying(self) -> tuple[VaryingProperty, ...]:
        """Varying properties of the token's classes, without duplicates."""
        merged = {varying.name: varying for member in self.classes for varying in member.varying}
        return tuple(merged.values())

    @property
    def basic_actions(self) -> tuple[BasicAction, ...]:
        """Basic actions of the token's capability classes, without duplicates, sorted by name."""
        merged = {action.name: action for member in self.classes for action in member.basic_actions}
        return tuple(merged[name] for name in sorted(merged))


def different(values: Iterable[object]) -> bool:
    """Return whether no token occurs twice among the values. Symbols may repeat."""
    names = [value.name for value in values if isinstance(value, Token)]
    return len(set(names)) == len(names)
