"""Write plain data as YAML 1.2 text that `nodes.parse` reads as the same data."""

import io
import re
from collections.abc import Mapping, Sequence
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.scalarstring import DoubleQuotedScalarString

from hybrid_tamp.taskfile.yaml.scalars import value_of

_WORDS = re.compile(r"\w[\w./-]*([ :][\w./-]+)*")
_WIDTH = 4096
"""Longer than any line, so that no line is wrapped."""


def round_trip_yaml() -> YAML:
    """Return a reader and writer that keeps comments, quotes and the order of keys."""
    yaml = YAML(typ="rt")
    yaml.preserve_quotes = True
    yaml.width = _WIDTH
    yaml.indent(mapping=2, sequence=4, offset=2)
    return yaml


def one_line(value: Any) -> Any:
    """Return a value whose lists and mappings are written on one line each."""
    if isinstance(value, Mapping):
        mapping = CommentedMap((key, one_line(each)) for key, each in value.items())
        mapping.fa.set_flow_style()
        return mapping
    if isinstance(value, Sequence) and not isinstance(value, str):
        row = CommentedSeq(map(one_line, value))
        row.fa.set_flow_style()
        return row
    return value


def dump(data: Any) -> str:
    """Return data as YAML text, with the comments, quotes and layout that `round_trip_yaml` has read."""
    out = io.StringIO()
    round_trip_yaml().dump(data, out)
    return out.getvalue()


def quoted(data: Any) -> Any:
    """Return data in which text has quotes if YAML would read it as something else without them."""
    if isinstance(data, Mapping):
        mapping = CommentedMap((quoted(key), quoted(value)) for key, value in data.items())
        return _like(data, mapping)
    if isinstance(data, list):
        return _like(data, CommentedSeq(map(quoted, data)))
    if isinstance(data, str) and not (_WORDS.fullmatch(data) and isinstance(value_of(data), str)):
        return DoubleQuotedScalarString(data)
    return data


def _like(data: Any, copy: Any) -> Any:
    """Return a copy that is written on one line if the original is."""
    if isinstance(data, CommentedMap | CommentedSeq) and data.fa.flow_style():
        copy.fa.set_flow_style()
    return copy
