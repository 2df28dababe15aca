"""JSON documents and their JSON Schemas, both derived from the dataclasses of `model/` and the keys of `keys.py`.

`document` turns a result, e.g. a `RunResult`, into plain data with the published keys. Documents have no classes of
their own. Each key names an attribute of the result, and the attribute's type determines the JSON Schema of the key.
"""

import inspect
import re
from collections.abc import Mapping
from dataclasses import field as dataclass_field
from dataclasses import fields, is_dataclass, make_dataclass
from enum import Enum
from functools import cache, cached_property, reduce
from keyword import iskeyword
from math import isfinite
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from pydantic import ConfigDict, Field, TypeAdapter

from hybrid_tamp.report.keys import DOCUMENTS, KEYS, TEXTS, Key, Keys

Json = dict[str, Any]
"""Plain data of the kind that `json.loads` returns."""


def document(result: Any) -> Json:
    """Return the document of a result.

    Args:
        result: an instance of one of the classes in `DOCUMENTS`.
    """
    (stem,) = (stem for stem, of in DOCUMENTS.items() if isinstance(result, of))
    return {"schema": _schema_name(stem), **_object(result, None)}


def parse_document(stem: str, content: bytes) -> Json:
    """Return the document in a JSON file, with defaults for missing keys.

    Args:
        stem: name of the document, e.g. ``plan-1``.
        content: the content of the file.

    Raises:
        ValidationError: the content is not JSON, or does not follow the published JSON Schema.
    """
    adapter = _adapter(stem)
    found: Json = adapter.dump_python(adapter.validate_json(content), by_alias=True, mode="json")
    return found


def json_schemas() -> dict[str, Json]:
    """Return a dictionary that maps the file stem of each document to the document's JSON Schema."""
    dialect = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    return {stem: dialect | _adapter(stem).json_schema(by_alias=True) for stem in DOCUMENTS}


def _schema_name(stem: str) -> str:
    name, _, version = stem.rpartition("-")
    return f"hybrid-tamp/{name}/{version}"


@cache
def _adapter(stem: str) -> TypeAdapter[Any]:
    name = _schema_name(stem)
    schema = ("schema", Literal[name], dataclass_field(default=name))
    return TypeAdapter(_form(DOCUMENTS[stem], None, "", schema))


def _object(value: Any, keys: Keys | None) -> Json:
    """Return a dataclass instance as plain data."""
    return {key.name: _data(_read(value, key), key.keys) for key in _keys(type(value), keys)}


def _data(value: Any, keys: Keys | None = None) -> Any:
    """Return a value as plain data. Infinity and NaN become null, because JSON cannot express them."""
    text = TEXTS.get(type(value))
    if text is not None:
        return text(value)
    if is_dataclass(value):
        return _object(value, keys)
    if isinstance(value, Mapping):
        return {name: _data(each, keys) for name, each in value.items()}
    if isinstance(value, tuple | list):
        return [_data(each, keys) for each in value]
    if isinstance(value, Enum):
        return value.value
    return None if isinstance(value, float) and not isfinite(value) else value


def _read(value: Any, key: Key) -> Any:
    if isinstance(key.source, str):
        return reduce(getattr, key.source.split("."), value)
    return key.source(value)


def _keys(of: type, keys: Keys | None) -> tuple[Key, ...]:
    """Return the given keys. The default is the dataclass's keys in `KEYS`, or else one key for each field."""
    wanted = keys or KEYS.get(of) or tuple(field.name for field in fields(of))
    return tuple(Key(each) if isinstance(each, str) else each for each in wanted)


@cache
def _form(of: type, keys: Keys | None, name: str = "", *more: Any) -> type:
    """Return a dataclass whose fields are the keys of a document. pydantic derives the JSON Schema from this class."""
    namespace = {"__doc__": (of.__doc__ or "").partition("\n")[0], "__pydantic_config__": ConfigDict(extra="forbid")}
    made = [_form_field(of, key) for key in _keys(of, keys)]
    return make_dataclass(name or of.__name__, [*more, *made], namespace=namespace, kw_only=True)


def _form_field(of: type, key: Key) -> tuple[str, Any, Any]:
    shown, described = _resolve(of, key)
    kind: Any = _form_type(shown, key)
    name = f"{key.name}_" if iskeyword(key.name) else key.name
    default = {"default_factory" if callable(key.default) else "default": key.default}
    form = Field(**default, alias=key.name, description=described or None)
    return name, kind | None if key.nullable else kind, dataclass_field(default=form)


def _form_type(kind: Any, key: Key) -> Any:
    """Return the type that a value of type `kind` has in the document."""
    if kind in TEXTS:
        return str
    if isinstance(kind, type) and is_dataclass(kind):
        return _form(kind, key.keys, key.name.title() if key.keys else "")
    origin = get_origin(kind)
    if origin in (None, Literal):
        return kind
    inner: Any = tuple(_form_type(each, key) for each in get_args(kind) if each is not Ellipsis)
    if origin in (Union, UnionType):
        return Union[inner]  # noqa: UP007
    return dict.__class_getitem__(inner) if issubclass(origin, Mapping) else list[Union[inner]]  # noqa: UP007


def _resolve(of: type, key: Key) -> tuple[Any, str]:
    """Return the type of a key's value and the value's description from a docstring."""
    if not isinstance(key.source, str):
        return get_type_hints(key.source)["return"], inspect.getdoc(key.source) or ""
    kind: Any = of
    described = ""
    for name in key.source.split("."):
        kind = next((each for each in get_args(kind) if each is not NoneType), kind)
        described = _described(kind, name)
        member = inspect.getattr_static(kind, name, None)
        function = member.func if isinstance(member, cached_property) else getattr(member, "fget", None)
        if function is not None:
            kind = get_type_hints(function)["return"]
        else:
            (kind,) = (field.type for field in fields(kind) if field.name == name)
    return kind, described


def _described(of: type, name: str) -> str:
    """Return an attribute's description, which is read from the docstring of the class."""
    member = inspect.getattr_static(of, name, None)
    if isinstance(member, property | cached_property):
        return (inspect.getdoc(member) or "").partition("\n")[0]
    found = re.search(rf"^    {name}: (.*(?:\n {{8}}.*)*)", inspect.getdoc(of) or "", re.MULTILINE)
    return " ".join(found[1].split()) if found else ""
