"""Translate pydantic's validation errors to faults of a file."""

import math
from collections.abc import Callable
from types import NoneType
from typing import Annotated, Any, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from hybrid_tamp.errors import did_you_mean
from hybrid_tamp.geometry.shapes import LARGEST_ANGLE
from hybrid_tamp.taskfile.places import Faults, KeyPath, dotted, shown

_TASK_FILE = "the task file"
_MAPPING = "must be a mapping of keys to values"
_WANTED = {
    "bool_type": "must be true or false",
    "dict_type": _MAPPING,
    "finite_number": "must be a finite number",
    "float_type": "must be a number",
    "greater_than": "must be more than {gt}",
    "greater_than_equal": "must be at least {ge}",
    "int_type": "must be a whole number",
    "less_than": "must be less than {lt}",
    "less_than_equal": "must be at most {le}",
    "list_type": "must be a list",
    "literal_error": "must be {expected}",
    "model_attributes_type": _MAPPING,
    "model_type": _MAPPING,
    "string_pattern_mismatch": "must consist of letters, digits, '-', '_', '.', '[' and ']'",
    "string_too_short": "must not be empty",
    "string_type": "must be text",
    "too_long": "must be a list of {max_length} entries",
    "too_short": "must have at least {min_length} entry",
    "tuple_type": "must be a list",
    "union_tag_not_found": "must have the key 'kind'",
}
_REMOVED: dict[KeyPath, str] = {
    ("midlevel", "seconds"): "delete the key, because midlevel.evaluations limits the search",
}
"""Maps the path of each removed key to advice that replaces the key."""
_BOUNDS = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")
_NUMBERS = ("finite_number", "float_type", *_BOUNDS)
_MOST_DEGREES = 720.0
"""Largest number that is taken for an angle in degrees."""


def add_validation_faults(
    faults: Faults,
    error: ValidationError,
    model: type[BaseModel],
    base: KeyPath = (),
    why: Callable[[str], str] = lambda key: "",
    whole: str = _TASK_FILE,
) -> None:
    """Record a fault for each error that pydantic found, at the place of the error in the file.

    Args:
        faults: the faults to which the errors are added.
        error: the error that pydantic raised.
        model: the validated model, whose fields give the units, descriptions and known keys.
        base: path of the validated part within the file.
        why: function that returns the reason why a key is required. The message appends the reason.
        whole: name of the whole file in messages.
    """
    for details in error.errors(include_url=False):
        way = _Way(model, details["loc"])
        path = base + way.path
        if details["type"] == "missing":
            _add_missing(faults, way, path, details["input"], why, whole)
        elif details["type"] == "extra_forbidden" and path in _REMOVED:
            faults.at(path, f"the key {dotted(path)} no longer exists", remedy=_REMOVED[path], key=True)
        elif details["type"] == "extra_forbidden":
            faults.at(path, f"unknown key in {subject(path[:-1], whole)}", shown(path[-1]), way.siblings, key=True)
        elif details["type"] == "union_tag_invalid":
            tags = [tag.strip(" '") for tag in details["ctx"]["expected_tags"].split(",")]
            path = (*path, details["ctx"]["discriminator"].strip("'"))
            faults.at(path, f"{subject(path)} must be a known kind", shown(details["ctx"]["tag"]), tags)
        else:
            wanted = _wanted(details, way.unit)
            # The message lists all choices and suggests the choice that is most similar to the given value.
            close = did_you_mean(str(details["input"]), way.choices) if details["type"] == "literal_error" else None
            came = faults.shown(path, details["input"])
            remedy = advise_radians(way.unit, details["input"]) if details["type"] in _BOUNDS else ""
            faults.at(path, f"{subject(path, whole)} {wanted}", came, (close,) if close else (), remedy)


def advise_radians(unit: str, value: object) -> str:
    """Return the advice to convert a number to radians if the number is an angle that was probably given in degrees.

    Args:
        unit: unit of the number, with or without brackets.
        value: the number. If the value is not a number, the advice is empty.
    """
    if unit.strip(" []") != "rad" or isinstance(value, bool) or not isinstance(value, int | float):
        return ""
    if not LARGEST_ANGLE < abs(value) <= _MOST_DEGREES:
        return ""
    return f"angles are in radians: {value:g} degrees are {math.radians(value)!r} rad"


def _wanted(details: ErrorDetails, unit: str) -> str:
    context = {
        key: f"{value:g}" if isinstance(value, float) else value for key, value in details.get("ctx", {}).items()
    }
    if details["type"] == "value_error":
        return f"is not valid: {context['error']}"
    template = _WANTED.get(details["type"])
    if template is None:
        return details["msg"].replace("Input should", "must", 1)
    return template.format(**context) + (unit if details["type"] in _NUMBERS else "")


def _add_missing(faults: Faults, way: "_Way", path: KeyPath, came: Any, why: Callable[[str], str], whole: str) -> None:
    last = path[-1]
    if isinstance(last, int):
        faults.at(path[:-1], f"{subject(path[:-1])} must be a list of {way.length} entries", shown(came))
        return
    description = ": " + way.field.description if way.field and way.field.description else ""
    faults.at(path, f"missing key {last!r}{way.unit} in {subject(path[:-1], whole)}{description}{why(last)}")


class _Way:
    """Path through the declarations of a model to the location of an error."""

    def __init__(self, model: type[BaseModel], loc: tuple[int | str, ...]) -> None:
        self.path: KeyPath = ()  # the location without the tags of unions, which are not in the file
        self.field: FieldInfo | None = None  # the innermost declared field on the path
        self.siblings: tuple[str, ...] = ()  # the keys of the innermost model on the path
        self.length = 0  # number of entries in the innermost tuple on the path
        here: Any = model
        for step in loc:
            members = _members(here)
            if len(members) > 1:
                here = next((m for m in members if step in _tags(m)), Any)
            else:
                here = self._into(members[0], step)
                self.path += (step,)

    @property
    def choices(self) -> tuple[str, ...]:
        """Accepted values of the innermost field; empty if they cannot be listed."""
        return tuple(map(str, get_args(self.field.annotation))) if self.field else ()

    @property
    def unit(self) -> str:
        """Unit of the innermost field in brackets; empty for pure numbers."""
        extra = self.field.json_schema_extra if self.field else None
        unit = extra.get("unit", "1") if isinstance(extra, dict) else "1"
        return "" if unit == "1" else f" [{unit}]"

    def _into(self, here: Any, step: int | str) -> Any:
        arguments = get_args(here)
        if isinstance(here, type) and issubclass(here, BaseModel):
            self.siblings = tuple(here.model_fields)
            self.field = here.model_fields.get(str(step))
            return self.field.annotation if self.field else Any
        if get_origin(here) is tuple:
            self.length = len(arguments)
        # The last argument is the type of the values of a mapping, list or tuple. Skip the ellipsis of a tuple.
        return next((one for one in reversed(arguments) if one is not Ellipsis), Any)


def _tags(member: Any) -> tuple[Any, ...]:
    """Return the names by which error locations refer to a member of a union: the kinds of a model, or a type name."""
    kinds = member.model_fields.get("kind") if issubclass(member, BaseModel) else None
    return get_args(kinds.annotation) if kinds else (member.__name__,)


def _members(annotation: Any) -> tuple[Any, ...]:
    """Return the members of a union except None. If the type is not a union, return the type itself."""
    if get_origin(annotation) is Annotated:
        return _members(get_args(annotation)[0])
    if get_origin(annotation) in (None, list, dict, tuple):
        return (annotation,)
    return tuple(member for one in get_args(annotation) if one is not NoneType for member in _members(one))


def subject(path: KeyPath, whole: str = _TASK_FILE) -> str:
    """Return the name of a task file's value for messages, e.g. ``pose.position[2] of token 'drum'``."""
    if not path:
        return whole
    if path[0] != "tokens" or len(path) == 1:
        return dotted(path)
    token = f"token {shown(path[1])}"
    rest = path[3:] if path[2:3] == ("properties",) and len(path) > 3 else path[2:]
    return f"{dotted(rest)} of {token}" if rest else token
