"""Unions of the properties of several classes.

If two classes declare the same property, their union has that property once. Multiple inheritance in pydantic would
merge conflicting declarations silently. `union_of` raises an error for them, in any order of the classes.
"""

from collections.abc import Iterable
from functools import lru_cache
from typing import Any, get_args

from pydantic import BaseModel, ConfigDict, create_model
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from hybrid_tamp.errors import Issue
from hybrid_tamp.model.affordance import TOKEN, BystanderProperties, ObjectClass


class PropertyConflictError(ValueError):
    """Error for classes that declare the same property differently. `issues` has one entry for each difference."""

    def __init__(self, issues: Iterable[Issue]) -> None:
        self.issues = tuple(issues)
        super().__init__("\n".join(map(str, self.issues)))


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
    for object_class in sort_classes(classes):
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


def sort_classes(classes: Iterable[type[ObjectClass]]) -> tuple[type[ObjectClass], ...]:
    """Return the classes without duplicates, sorted by name."""
    return tuple(sorted(set(classes), key=lambda object_class: object_class.name))


def union_of(classes: Iterable[type[ObjectClass]], unknown: Iterable[type[ObjectClass]] = ()) -> type[BaseModel]:
    """Return the pydantic model whose fields are the union of the classes' properties.

    A token that is a member of `TOKEN` only has `BystanderProperties`.

    Args:
        classes: object classes, in any order.
        unknown: classes of which the token may be a member. Properties that only these classes declare may be missing.

    Raises:
        PropertyConflictError: if two classes declare the same property with different types, units, bounds or defaults.
    """
    members, doubtful = sort_classes(classes), sort_classes(unknown)
    return BystanderProperties if members == (TOKEN,) and not doubtful else _union(members, doubtful)


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
