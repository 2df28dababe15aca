"""Resolve scalars by the core schema of YAML 1.2 (Sec. 10.3.2). For example, `no` is text and `010` is ten.

The parser's own tables are not used, because they accept underscores, binary numbers and dates (not YAML 1.2).
"""

import re
from dataclasses import dataclass
from typing import Any

from ruamel.yaml.events import CollectionStartEvent, MappingStartEvent, ScalarEvent

from hybrid_tamp.taskfile.places import cut, shown

_CORE = "tag:yaml.org,2002:"
_NULL = re.compile("|~|null|Null|NULL")
_BOOLEAN = re.compile("true|True|TRUE|false|False|FALSE")
_DECIMAL = re.compile("[-+]?[0-9]+")
_BASES = {8: re.compile("0o([0-7]+)"), 16: re.compile("0x([0-9a-fA-F]+)")}
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_INFINITE = re.compile(r"([-+]?)\.(inf|Inf|INF)")
_NOT_A_NUMBER = re.compile(r"\.(nan|NaN|NAN)")
_LONGEST_INTEGER = 250
_TYPES: dict[str, type | tuple[type, ...]] = {"null": type(None), "bool": bool, "int": int, "float": float}


@dataclass(eq=False)
class Unresolvable(Exception):
    """Exception for a scalar or tag that cannot be resolved. The attributes are the parts of an `Issue`."""

    wanted: str
    came: str
    remedy: str = ""


def resolve(event: ScalarEvent) -> Any:
    """Return the value of a scalar: text, number, truth value or None.

    Raises:
        Unresolvable: the tag is not in the core schema, the text does not fit the tag, or the text has half of a
            surrogate pair.
    """
    text = _whole_characters(event.value)
    tag = _tag(event)
    if tag is None:
        return value_of(text) if event.style is None or event.style == "" else text
    if tag in ("!", _CORE + "str"):
        return text
    wanted = _TYPES.get(tag.removeprefix(_CORE)) if tag.startswith(_CORE) else None
    if wanted is None:
        raise _refused(tag)
    value = value_of(text)
    if wanted is float and type(value) is int:
        return float(value)
    if type(value) is not wanted:
        raise Unresolvable(f"a value must fit its tag {_written(tag)}", shown(text), "remove the tag")
    return value


def check_tag(event: CollectionStartEvent) -> None:
    """Raise `Unresolvable` if the tag of a list or mapping names another type."""
    own = _CORE + ("map" if isinstance(event, MappingStartEvent) else "seq")
    tag = _tag(event)
    if tag not in (None, "!", own):
        raise _refused(str(tag))


def _tag(event: ScalarEvent | CollectionStartEvent) -> str | None:
    return None if event.ctag is None else str(event.ctag)


def _refused(tag: str) -> Unresolvable:
    wanted = "a task file must be plain data that constructs no objects"
    return Unresolvable(wanted, f"the tag {_written(tag)}", "remove the tag")


def _written(tag: str) -> str:
    return cut("!!" + tag.removeprefix(_CORE) if tag.startswith(_CORE) else tag)


def _whole_characters(text: str) -> str:
    r"""Join the surrogate pairs that JSON writes, e.g. ``"\ud83d\ude00"``."""
    try:
        return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le")
    except UnicodeDecodeError as error:
        remedy = r"write the character itself, or as \U and 8 digits"
        raise Unresolvable("text must be whole characters", "half of a surrogate pair", remedy) from error


def value_of(text: str) -> Any:
    """Return the value of a scalar without quotes: a number, a truth value, None or the text itself."""
    if _NULL.fullmatch(text):
        return None
    if _BOOLEAN.fullmatch(text):
        return text.lower() == "true"
    if _DECIMAL.fullmatch(text):
        # Python cannot convert very long integers. Infinity is returned here and later refused with its place.
        return int(text) if len(text) <= _LONGEST_INTEGER else float(text)
    for base, pattern in _BASES.items():
        if digits := pattern.fullmatch(text):
            return int(digits[1], base) if len(text) <= _LONGEST_INTEGER else float("inf")
    if _FLOAT.fullmatch(text):
        return float(text)
    if infinite := _INFINITE.fullmatch(text):
        return float(f"{infinite[1]}inf")
    return float("nan") if _NOT_A_NUMBER.fullmatch(text) else text
