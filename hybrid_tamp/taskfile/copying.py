"""A task file for another folder: its text, with the files that it names beside it."""

from pathlib import Path

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.task import Task
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.meshfile import MOST_BYTES
from hybrid_tamp.taskfile.saving import differences, task_text
from hybrid_tamp.taskfile.yaml.nodes import parse, read_text


def portable(task: Task) -> tuple[str, dict[str, str]]:
    """Return the text of a task's file as it may stand in another folder, and the files that go beside it.

    The text of the file that the task came from stays as it is, letter for letter, but for the names of those files.
    If there is no such file, or it describes another scene or goal by now, the text is made from the task.

    Returns:
        The text, and name to text of the primitive and mesh files that it names.

    Raises:
        InputError: a file cannot be read.
    """
    if task.source is None or not _describes(task.source, task):
        return task_text(task)
    return _with_files(task.source)


def _describes(path: Path, task: Task) -> bool:
    """Say whether a file has the task's tokens and goal; its limits and seed may differ."""
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
