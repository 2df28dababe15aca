"""Convert pydantic models to JSON Schema, and describe JSON Schema in words."""

from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

JsonObject = dict[str, Any]


@dataclass(frozen=True)
class Form:
    """The keys of a model.

    Attributes:
        keys: maps each key to its JSON Schema, with the unit in the description.
        required: keys without a default, in order.
        definitions: maps the name of each referenced schema to the schema.
    """

    keys: dict[str, JsonObject]
    required: tuple[str, ...]
    definitions: dict[str, JsonObject]


def form_of(model: type[BaseModel], prefix: str = "") -> Form:
    """Return the keys of a model.

    Args:
        model: a pydantic model, e.g. an object class.
        prefix: prefix of the names of the model's definitions, so that the names differ between models.
    """
    schema = model.model_json_schema(ref_template=f"#/$defs/{prefix}{{model}}")
    definitions = {f"{prefix}{name}": one for name, one in schema.pop("$defs", {}).items()}
    return Form(
        keys=_with_units(schema.get("properties", {})),
        required=tuple(schema.get("required", ())),
        definitions=_with_units(definitions),
    )


def _with_units(schema: Any) -> Any:
    """Return a copy of a schema with the unit at the end of every description. Editors show only descriptions."""
    if isinstance(schema, list):
        return [_with_units(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    copy = {key: _with_units(value) for key, value in schema.items()}
    unit = copy.get("unit")
    if isinstance(unit, str) and unit != "1" and isinstance(copy.get("description"), str):
        copy["description"] += f" [{unit}]"
    return copy


def type_in_words(schema: JsonObject) -> str:
    """Return the type of a schema's values as text, e.g. ``list of 3 numbers``."""
    if "$ref" in schema:
        return f"`{schema['$ref'].rsplit('/', 1)[-1]}`"
    if "const" in schema:
        return f"`{schema['const']}`"
    if "enum" in schema:
        return " or ".join(f"`{value}`" for value in schema["enum"])
    every: list[JsonObject] = schema.get("anyOf") or schema.get("oneOf") or []
    choices = [one for one in every if one.get("type") != "null"]
    if choices:
        return " or ".join(dict.fromkeys(map(type_in_words, choices)))
    if "prefixItems" in schema:
        return f"list of {len(schema['prefixItems'])} {type_in_words(schema['prefixItems'][0])}s"
    if schema.get("type") == "array":
        return f"list of {type_in_words(schema['items'])}" if schema.get("items") else "list"
    if schema.get("type") == "object":
        values = schema.get("additionalProperties")
        return f"mapping of names to {type_in_words(values)}" if isinstance(values, dict) else "mapping"
    words = {"string": "text", "integer": "whole number", "boolean": "true or false"}
    kind = str(schema.get("type", "any value"))
    return words.get(kind, kind)


_BOUNDS = (("exclusiveMinimum", ">"), ("minimum", "≥"), ("exclusiveMaximum", "<"), ("maximum", "≤"))


def bounds_in_words(schema: JsonObject) -> str:
    """Return the bounds of a number, or of the numbers in a list, as text, e.g. ``> 0, ≤ 10``."""
    inner = [one for one in schema.get("anyOf", ()) if one.get("type") != "null"] or [schema]
    one = inner[0].get("prefixItems", inner)[0]
    return ", ".join(f"{sign} {number_in_words(one[key])}" for key, sign in _BOUNDS if key in one)


def number_in_words(value: float) -> str:
    """Return a number as text, without a decimal point for whole numbers."""
    return str(int(value)) if float(value).is_integer() else f"{value:g}"
