"""Object tokens: the union of their classes' properties (paper, Sec. II-A).

If two classes have the same property, the token has one instance of it. pydantic's own multiple inheritance
would merge conflicting fields silently by base order; `union_of` refuses them instead, and does not depend on
the order of the classes.
"""

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from types import MappingProxyType
from typing import Any

from pydantic import BaseModel, ConfigDict, create_model
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from hybrid_tamp.errors import Issue
from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.model.affordance import TOKEN, BasicAction, ObjectClass, VaryingProperty, is_place


class PropertyConflictError(ValueError):
    """Two classes declare one property differently; `issues` holds every such pair."""

    def __init__(self, issues: Iterable[Issue]) -> None:
        self.issues = tuple(issues)
        super().__init__("\n".join(map(str, self.issues)))


def _declaration(field: FieldInfo) -> dict[str, str]:
    """Return the declarations of a property on which all its classes must agree."""
    extra = field.json_schema_extra
    return {
        "type": str(field.annotation),
        "bounds": ", ".join(sorted(str(item) for item in field.metadata)) or "none",
        "unit": str(extra.get("unit", "1")) if isinstance(extra, dict) else "1",
        "default": "none" if field.default is PydanticUndefined else repr(field.default),
    }


def conflicts(classes: Iterable[type[ObjectClass]]) -> list[Issue]:
    """Return one issue for each difference between two classes' declarations of one property."""
    seen: dict[str, tuple[str, dict[str, str]]] = {}
    found = []
    for object_class in _ordered(classes):
        for name, field in object_class.model_fields.items():
            mine = _declaration(field)
            owner, theirs = seen.setdefault(name, (object_class.name, mine))
            differing = [key for key in mine if mine[key] != theirs[key]]
            for key in differing:
                found.append(
                    Issue(
                        where=f"{owner} and {object_class.name}",
                        wanted=f"both classes must declare {key} of property {name!r} alike",
                        came=f"{theirs[key]} in {owner}, {mine[key]} in {object_class.name}",
                        remedy="rename the property in one of the classes",
                    )
                )
    return found


def _ordered(classes: Iterable[type[ObjectClass]]) -> tuple[type[ObjectClass], ...]:
    return tuple(sorted(set(classes), key=lambda object_class: object_class.name))


def union_of(classes: Iterable[type[ObjectClass]], unknown: Iterable[type[ObjectClass]] = ()) -> type[BaseModel]:
    """Return the model whose fields are the union of the classes' properties.

    Args:
        classes: object classes in any order.
        unknown: further classes; their properties may be missing.

    Raises:
        PropertyConflictError: two classes declare one property with another type, unit, bound or default.
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
            # A missing property is None, which is no valid value.
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
        name: the user's own name.
        classes: the object classes that the token is a member of, the root class included, sorted by name.
        properties: the union of the classes' fixed properties, name to value.
        shape: its geometry, or None for a place without one.
        unknown: the classes for which its membership is unknown.
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
        """Validate the properties against the union of the classes; those of unknown classes may be missing.

        Raises:
            PropertyConflictError: the classes contradict each other.
            pydantic.ValidationError: a property is missing, unknown, of a wrong type or out of bounds.
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
        """Return a fixed property by name; KeyError if no class of the token has it."""
        return self.properties[property_name]

    def __repr__(self) -> str:
        return f"Token({self.name!r}: {', '.join(member.name for member in self.classes)})"

    @property
    def solid(self) -> Shape:
        """The shape of a token that must have one.

        Raises:
            ValueError: the token has no shape.
        """
        if self.shape is None:
            raise ValueError(f"{self.name} has no shape")
        return self.shape

    def is_member(self, object_class: type[ObjectClass]) -> bool:
        """Say whether the token is a member of the class."""
        return any(issubclass(member, object_class) for member in self.classes)

    def may_be_member(self, object_class: type[ObjectClass]) -> bool:
        """Say whether the token's membership of the class is unknown."""
        return not self.is_member(object_class) and any(issubclass(each, object_class) for each in self.unknown)

    @cached_property
    def fixed(self) -> Hashable:
        """Its classes, properties and shape: equal for tokens that differ only in name and state."""
        key = (self.classes, tuple(sorted(self.properties.items())), self.shape)
        try:
            hash(key)
        except TypeError:
            return self.name
        return key

    @property
    def place(self) -> bool:
        """Whether the token is a place: a target that is never in a slot."""
        return any(is_place(member) for member in self.classes)

    @property
    def varying(self) -> tuple[VaryingProperty, ...]:
        """The distinct varying properties of the token's classes."""
        merged = {varying.name: varying for member in self.classes for varying in member.varying}
        return tuple(merged.values())

    @property
    def basic_actions(self) -> tuple[BasicAction, ...]:
        """The distinct basic actions of the token's capability classes, sorted by name."""
        merged = {action.name: action for member in self.classes for action in member.basic_actions}
        return tuple(merged[name] for name in sorted(merged))


def different(values: Iterable[object]) -> bool:
    """Say whether all tokens are different; symbols may repeat."""
    names = [value.name for value in values if isinstance(value, Token)]
    return len(set(names)) == len(names)
