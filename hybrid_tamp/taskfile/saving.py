"""Save a task as a task file, together with mesh and primitive files. The task can be loaded again from the file."""

import os
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from ruamel.yaml.comments import CommentedSeq

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.geometry.meshes import MeshShape
from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.task import Limits, MidLevel, Range, Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.meshfile import MOST_BYTES, digest_of
from hybrid_tamp.taskfile.yaml.dumping import dump, one_line, quoted
from hybrid_tamp.taskfile.yaml.nodes import read_text

TOLERANCE = 1e-12
"""Largest accepted difference of a number after loading, which normalises directions and quaternions again."""


def save_task(task: Task, path: Path | str) -> None:
    """Write a task as a YAML task file, from which `load_task` reads an equal task.

    An existing file is replaced. Mesh files and primitive files are copied into the folder of the task file.

    Args:
        task: the task. Only the name of the task's domain is written.
        path: path of the task file.

    Raises:
        InputError: the file cannot be written or would not load as the same task. For example, two tokens overlap, or
            the state has a velocity, which a task file cannot express.
    """
    path = Path(path)
    text, files = task_text(task, path.stem, lambda name, content: _is_free(path.parent / name, content))
    for name, content in files.items():
        with _writing(path.parent / name):
            (path.parent / name).write_bytes(content.encode("utf-8"))
    write_checked(path, text, lambda written: _check_same(task, written, path))


def write_checked(path: Path, text: str, check: Callable[[Path], object]) -> None:
    """Write a task file under a temporary name in the same folder, check the file and rename it.

    Raises:
        InputError: the file cannot be written.
    """
    with _writing(path):
        descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}.", suffix=".yaml")
        try:
            with os.fdopen(descriptor, "w", encoding="utf-8") as file:
                file.write(text)
            check(Path(name))
            os.chmod(name, 0o644)
            os.replace(name, path)
        finally:
            with suppress(FileNotFoundError):
                os.unlink(name)


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Translate errors of the operating system to `InputError`."""
    try:
        yield
    except OSError as error:
        raise InputError([Issue(str(path), "cannot write the file", str(error.strerror))]) from error


def task_text(
    task: Task, stem: str | None = None, free: Callable[[str, str], bool] = lambda name, content: True
) -> tuple[str, dict[str, str]]:
    """Return the text of a task file, and the files that belong in the same folder.

    Args:
        task: the task.
        stem: name of the task file without its ending. If the task's name equals the stem, the text omits the name.
        free: function of (name, content) that returns whether a file with this name and content may be written.

    Returns:
        The text, and a mapping from the name of each mesh and primitive file to its content.

    Raises:
        InputError: a mesh or primitive file cannot be read, or has changed since the task was made.
    """
    files: dict[str, str] = {}
    beside = partial(_beside, files, free)
    data = {
        "domain": task.domain.name,
        "name": None if task.name == stem else task.name,
        "agents": {agent: one_line(names) for agent, names in task.agents.items()},
        "tokens": {token.name: dict(_token_entry(task, token, beside)) for token in task.tokens},
        "goal": _goal(task),
        "assignment": {name: block for name, block in task.assignment.items() if block != task.domain.resting},
        "primitives": {
            key: beside(path.name, read_text(path, "a primitive file")) for key, path in task.primitives.items()
        },
        "planner": task.planner,
        "objective": task.objective,
        "limits": one_line(_changed(task.limits, Limits())),
        "midlevel": _changed(task.midlevel, MidLevel()),
        "safety": one_line(dict(task.safety)),
        "seed": task.seed,
    }
    return dump(quoted({key: value for key, value in data.items() if value not in (None, {})})), files


def _beside(files: dict[str, str], free: Callable[[str, str], bool], name: str, content: str) -> str:
    """Add a file under its name, or under a similar name if its name is taken. Return the chosen name."""
    stem, ending = Path(name).stem, Path(name).suffix
    number = 1
    while files.get(name, content) != content or not free(name, content):
        number += 1
        name = f"{stem}-{number}{ending}"
    files[name] = content
    return name


def _token_entry(task: Task, token: Token, beside: Callable[[str, str], str]) -> Iterator[tuple[str, Any]]:
    """Yield the keys and values of a token's entry."""
    yield "classes", one_line([member.name for member in token.classes if member is not TOKEN] or [TOKEN.name])
    if token.unknown:
        yield "unknown", one_line([member.name for member in token.unknown])
    if token.properties:
        yield "properties", {name: one_line(value) for name, value in token.properties.items()}
    implied = Token.make(token.name, token.classes, token.properties, unknown=token.unknown).shape
    if token.shape is not None and token.shape != implied:
        yield "shape", one_line(_shape(token.shape, beside))
    if token.immovable:
        yield "fixed", True
    varying = {one.name for one in token.varying}
    pose = {"position": task.state[token, "position"].tolist()} if "position" in varying else {}
    if "orientation" in varying and not np.array_equal(task.state[token, "orientation"], [0.0, 0.0, 0.0, 1.0]):
        pose["quaternion"] = task.state[token, "orientation"].tolist()
    if pose:
        yield "pose", one_line(pose)


def _shape(shape: Any, beside: Callable[[str, str], str]) -> Mapping[str, Any]:
    if not isinstance(shape, MeshShape):
        return dict(shape.model_dump())
    return {"kind": "mesh", "file": beside(shape.path.name, _mesh_text(shape)), "scale": shape.scale}


def _mesh_text(shape: MeshShape) -> str:
    text = read_text(shape.path, "a mesh file", MOST_BYTES)
    if digest_of(text) != shape.digest:
        raise InputError([Issue(str(shape.path), "the mesh file has changed since the task was made")])
    return text


def _goal(task: Task) -> CommentedSeq:
    negative = [atom for atom in task.goal if not atom.positive]
    if negative:
        wanted = "a task file cannot express a negated goal atom"
        raise InputError([Issue("goal", wanted, f"not {negative[0].predicate}")])
    return CommentedSeq([{atom.predicate: one_line(atom.arguments)} for atom in task.goal])


def _changed(value: Any, default: Any) -> dict[str, Any]:
    """Return each attribute of a record that differs from the same attribute of a default record."""
    found = {field.name: getattr(value, field.name) for field in fields(value)}
    return {key: _plain(each) for key, each in found.items() if each != getattr(default, key)}


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items()}
    return one_line(_changed(value, Range())) if isinstance(value, Range) else value


def _is_free(path: Path, content: str) -> bool:
    """Return whether the path is free for the content: no file exists there, or a file with this content."""
    return not path.exists() or (path.is_file() and path.read_bytes() == content.encode("utf-8"))


def _check_same(task: Task, written: Path, path: Path) -> None:
    """Raise `InputError` unless the written file loads as the same task."""
    again = load_task(written, lambda _: task.domain).replaced(name=task.name)
    different = [
        Issue(str(path), f"a task file cannot express this task; after loading, the {what}")
        for what in differences(task, again)
    ]
    if different:
        raise InputError(different)


def differences(task: Task, other: Task) -> list[str]:
    """Return a phrase for each difference between two tasks of one domain. Numbers may differ by `TOLERANCE`."""
    found = [
        f"{name} differs"
        for name in ("name", "goal", "agents", "planner", "limits", "seed", "objective", "midlevel", "safety")
        if getattr(task, name) != getattr(other, name)
    ]
    if [token.name for token in task.tokens] != [token.name for token in other.tokens]:
        return [*found, "tokens differ"]
    if any(task.start_block(one.name) is not other.start_block(one.name) for one in task.assigned):
        found.append("assignment differs")
    for one, same in zip(task.tokens, other.tokens, strict=True):
        if (one.classes, one.unknown) != (same.classes, same.unknown):
            found.append(f"classes of token {one.name} differ")
        if one.immovable != same.immovable:
            found.append(f"fixed of token {one.name} differs")
        if one.shape != same.shape:
            found.append(f"shape of token {one.name} differs")
        found += [
            f"{name} of token {one.name} differs"
            for name in sorted({*one.properties, *same.properties})
            if not _equal(one.properties.get(name), same.properties.get(name))
        ]
        found += [
            f"{varying.name} of token {one.name} differs"
            for varying in one.varying
            if not np.allclose(task.state[one, varying.name], other.state[same, varying.name], 0.0, TOLERANCE)
        ]
    return found


def _equal(one: Any, other: Any) -> bool:
    if isinstance(one, tuple | float) and isinstance(other, tuple | float):
        return np.shape(one) == np.shape(other) and bool(np.allclose(one, other, TOLERANCE, TOLERANCE))
    return bool(one == other)
