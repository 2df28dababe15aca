"""A task file in which a token is a member of more classes; comments and all else stay as they are."""

import io
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedSeq

from hybrid_tamp.taskfile.yaml.nodes import read_text

_WIDTH = 4096
"""Longer than any line, so that none is broken anew."""


def with_members(
    source: Path, target: Path, token: str, joined: Sequence[str], settled: Sequence[str], properties: Mapping[str, Any]
) -> str:
    """Return the text of a sound task file with one token's classes and properties changed.

    Args:
        source: the task file.
        target: where the text will stand; the paths of files that it names are written relative to that.
        token: the token.
        joined: names of the classes that it joins.
        settled: names of the classes in which it is unknown no more.
        properties: its properties as a member of what it joins.

    Raises:
        InputError: the file cannot be read.
    """
    yaml = YAML(typ="rt")
    yaml.preserve_quotes = True
    yaml.width = _WIDTH
    yaml.indent(mapping=2, sequence=4, offset=2)
    data = yaml.load(read_text(source))
    entry = data["tokens"][token]
    entry["classes"] += [name for name in joined if name not in entry["classes"]]
    left = [name for name in entry.get("unknown", ()) if name not in settled]
    if left:
        entry["unknown"] = _row(left)
    else:
        entry.pop("unknown", None)
    if properties:
        entry.setdefault("properties", {})
        for name, value in properties.items():
            if entry["properties"].get(name) != value:
                entry["properties"][name] = _row(value) if isinstance(value, tuple | list) else value
    _relocate(data, source.parent, target.parent)
    out = io.StringIO()
    yaml.dump(data, out)
    return out.getvalue()


def _row(values: Sequence[Any]) -> CommentedSeq:
    row = CommentedSeq(values)
    row.fa.set_flow_style()
    return row


def _relocate(data: Any, before: Path, after: Path) -> None:
    """Write relative paths so that they lead to the same files from another folder."""
    named = [(data["primitives"], key) for key in data.get("primitives", {})]
    shapes = [entry.get("shape") or {} for entry in data["tokens"].values()]
    for holder, key in (*named, *((shape, "file") for shape in shapes if "file" in shape)):
        if not Path(holder[key]).is_absolute():
            way = os.path.relpath((before / holder[key]).resolve(), after.resolve())
            holder[key] = Path(way).as_posix()
