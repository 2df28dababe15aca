"""Copy a task file to another folder together with its primitive and mesh files, and add primitives to a task."""

import logging
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.task import Task
from hybrid_tamp.taskfile.domains import BESIDE, file_of
from hybrid_tamp.taskfile.loader import FindDomain, load_task
from hybrid_tamp.taskfile.meshfile import MOST_BYTES
from hybrid_tamp.taskfile.primitives import PrimitiveFile, teach_block
from hybrid_tamp.taskfile.saving import differences, task_text
from hybrid_tamp.taskfile.yaml.nodes import parse, read_text

_logger = logging.getLogger(__name__)


def portable(task: Task) -> tuple[str, dict[str, str]]:
    """Return the text of a task file for another folder, and the files that belong in the same folder.

    The text is a copy of the task's file in which only the names of primitive and mesh files differ. If the task has no
    file, or if the file now describes another scene or goal, the text is generated from the task.

    Returns:
        The text, and a mapping from the name of each file to its content: primitive and mesh files, and the file of a
        domain that is not installed.

    Raises:
        InputError: a file cannot be read.
    """
    written = task.source is not None and _describes(task.source, task)
    text, named = _with_files(task.source) if task.source is not None and written else task_text(task)
    code = file_of(task.domain)
    return text, named if code is None else {**named, BESIDE: read_text(code)}


def _describes(path: Path, task: Task) -> bool:
    """Return whether a file has the same tokens and goal as a task. The limits and seed may differ."""
    try:
        written = load_task(path, lambda _: task.domain)
    except InputError:
        return False
    return not differences(_scene(task), _scene(written))


def _scene(task: Task) -> Task:
    """Return the task without its limits, seed, planner and other settings."""
    return Task("", task.domain, task.tokens, task.state, task.goal, task.agents, task.assignment)


def _with_files(path: Path) -> tuple[str, dict[str, str]]:
    text = read_text(path)
    document = parse(text, str(path))
    files: dict[str, str] = {}
    places: list[tuple[int, int, str]] = []
    for number, (key, named) in enumerate(document.data.get("primitives", {}).items(), start=1):
        name = f"primitive-{number:02d}.json"
        files[name] = read_text(path.parent / named, "a primitive file")
        places.append((*document.faults.spans["primitives", key], name))
    meshes: dict[str, str] = {}
    for token, entry in document.data.get("tokens", {}).items():
        named = (entry.get("shape") or {}).get("file")
        if named is not None:
            name = meshes.setdefault(named, f"mesh-{len(meshes) + 1:02d}.obj")
            files[name] = read_text(path.parent / named, "a mesh file", MOST_BYTES)
            places.append((*document.faults.spans["tokens", token, "shape", "file"], name))
    for first, last, name in sorted(places, reverse=True):
        text = text[:first] + name + text[last:]
    return text, files


def teach_task(task: Task, primitives: Mapping[str, PrimitiveFile], folder: Path, find_domain: FindDomain) -> Task:
    """Write a task file that names additional motor primitives, and return the task that is loaded from this file.

    A task that already names motor primitives is returned unchanged.

    Args:
        task: the task.
        primitives: maps each block to the block's new primitive.
        folder: folder for the new task file and its primitive and mesh files.
        find_domain: function that finds the domain by the name in the file.

    Raises:
        InputError: a file cannot be read or written.
    """
    if not primitives:
        return task
    if task.primitives:
        _logger.warning("the task %s already names motor primitives, so the new primitives are not used", task.name)
        return task
    names = {name: f"primitive-{number:02d}.json" for number, name in enumerate(primitives, start=1)}
    for name, primitive in primitives.items():
        (folder / names[name]).write_text(primitive.text, encoding="utf-8")
    if task.source is None:
        blocks = [task.domain.block_by_name[name] for name in primitives]
        taught = [teach_block(block, primitives[block.name].primitive) for block in blocks if block.taught is not None]
        files = {name: folder / file for name, file in names.items()}
        return task.replaced(domain=task.domain.with_blocks(taught), primitives=files)
    text, files_beside = portable(task)
    for name, content in files_beside.items():
        (folder / name).write_text(content, encoding="utf-8")
    lines = [f'  "{name}": {file}\n' for name, file in names.items()]
    path = folder / task.source.name
    path.write_text("".join([text.rstrip("\n"), "\n\nprimitives:\n", *lines]), encoding="utf-8")
    loaded = load_task(path, find_domain)
    return replace(task, domain=loaded.domain, primitives=loaded.primitives, source=path)
