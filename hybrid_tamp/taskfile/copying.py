"""A task file for another folder: its text, with the files that it names beside it."""

from pathlib import Path

from hybrid_tamp.taskfile.meshfile import MOST_BYTES
from hybrid_tamp.taskfile.yaml.nodes import parse, read_text


def portable(path: Path) -> tuple[str, dict[str, str]]:
    """Return a sound task file's text as it may stand in another folder, and the files that go beside it.

    Whatever else the text says stays as it is, letter for letter.

    Args:
        path: the task file.

    Returns:
        The text, and name to text of the primitive and mesh files that it names.

    Raises:
        InputError: a file cannot be read.
    """
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
