"""Add classes to one token of a task file. The rest of the file is kept, including comments."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hybrid_tamp.taskfile.yaml.dumping import dump, one_line, round_trip_yaml
from hybrid_tamp.taskfile.yaml.nodes import read_text


def with_members(
    source: Path, target: Path, token: str, joined: Sequence[str], settled: Sequence[str], properties: Mapping[str, Any]
) -> str:
    """Return the text of a task file with changed classes and properties of one token.

    Args:
        source: the task file, which must have no faults.
        target: the new task file. Paths in the text are relative to the folder of this file.
        token: name of the token.
        joined: names of the classes that are added to the token.
        settled: names of the classes that are removed from the token's unknown classes.
        properties: properties that the added classes declare.

    Raises:
        InputError: the file cannot be read.
    """
    data = round_trip_yaml().load(read_text(source))
    entry = data["tokens"][token]
    entry["classes"] += [name for name in joined if name not in entry["classes"]]
    left = [name for name in entry.get("unknown", ()) if name not in settled]
    if left:
        entry["unknown"] = one_line(left)
    else:
        entry.pop("unknown", None)
    if properties:
        entry.setdefault("properties", {})
        for name, value in properties.items():
            if entry["properties"].get(name) != value:
                entry["properties"][name] = one_line(value)
    _relocate(data, source.parent, target.parent)
    return dump(data)


def _relocate(data: Any, before: Path, after: Path) -> None:
    """Change relative paths so that they still name the same files after a move to another folder."""
    named = [(data["primitives"], key) for key in data.get("primitives", {})]
    shapes = [entry.get("shape") or {} for entry in data["tokens"].values()]
    for holder, key in (*named, *((shape, "file") for shape in shapes if "file" in shape)):
        if not Path(holder[key]).is_absolute():
            holder[key] = Path(os.path.relpath((before / holder[key]).resolve(), after.resolve())).as_posix()
