"""Write plain data as YAML 1.2. `nodes.parse` reads the same data from the text."""

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
"""Maximum line length, large enough that no line is wrapped."""


def round_trip_yaml() -> YAML:
    """Return a YAML reader and writer that keeps comments, quotes and the order of keys."""
    yaml = YAML(typ="rt")
    yaml.preserve_quotes = True
    yaml.width = _WIDTH
    yaml.indent(mapping=2, sequence=4, offset=2)
    return yaml


def one_line(value: Any) -> Any:
    """Return a copy of a value whose lists and mappings are written on one line."""
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
    """Return data as YAML text. Data read by `round_trip_yaml` keep their comments, quotes and layout."""
    out = io.StringIO()
    round_trip_yaml().dump(data, out)
    return out.getvalue()


def quoted(data: Any) -> Any:
    """Return a copy of data with quotes around each text that YAML would otherwise read as another type."""
    if isinstance(data, Mapping):
        return _like(data, CommentedMap((quoted(key), quoted(value)) for key, value in data.items()))
    if isinstance(data, list):
        return _like(data, CommentedSeq(map(quoted, data)))
    if isinstance(data, str) and not (_WORDS.fullmatch(data) and isinstance(value_of(data), str)):
        return DoubleQuotedScalarString(data)
    return data


def _like(data: Any, copy: Any) -> Any:
    """Return `copy`. If `data` is written on one line, the copy is also written on one line."""
    if isinstance(data, CommentedMap | CommentedSeq) and data.fa.flow_style():
        copy.fa.set_flow_style()
    return copy
