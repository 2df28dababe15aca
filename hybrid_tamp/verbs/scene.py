"""The verb ``scene``: add the bodies of URDF and mesh files to a task, as bodies that nothing can move."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.geometry.shapes import MeshFile
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import check_size
from hybrid_tamp.report.folder import check_new_file
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.meshfile import read_mesh
from hybrid_tamp.taskfile.saving import save_task
from hybrid_tamp.taskfile.urdf import SceneBody, read_urdf

_UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])


def add_scene(source: Task | Path | str, files: Sequence[Path | str], position: ArrayLike = (0.0, 0.0, 0.0)) -> Task:
    """Return a task with the bodies of files, which nothing can move, e.g. walls, tables and shelves.

    `save_task` writes the task, and checks that no body overlaps a body that can move.

    Args:
        source: a task, the path of a task file, or the name of a bundled task.
        files: URDF files and mesh files (OBJ). Each collision geometry of a URDF file and each mesh file becomes a
            token. A name that is taken gets a number.
        position: position of the origin of the files in the world [m], shape ``(3,)``.

    Raises:
        InputError: the task or a file has faults.
    """
    task, origin = load_task(source), check_size(position, 3, "position")
    taken = {token.name for token in task.tokens}
    tokens, given = (
        list(task.tokens),
        {(name, key): task.state[name, key] for name, key, _ in task.state.layout.entries},
    )
    for body in (body for file in files for body in _read(Path(file))):
        token = Token.make(_free_name(body.name, taken), [], {}, body.shape, immovable=True)
        taken.add(token.name)
        tokens.append(token)
        given[token.name, "position"], given[token.name, "orientation"] = origin + body.position, body.orientation
    return task.replaced(tokens=tuple(tokens), state=State.of(tokens, given), source=None)


def write_scene(
    source: str, files: Sequence[Path], target: Path, position: ArrayLike = (0.0, 0.0, 0.0), *, force: bool = False
) -> tuple[str, ...]:
    """Write a task file with the bodies of files (see `add_scene`), and return the names of the new tokens.

    Args:
        source: path of a task file, or the name of a bundled task.
        files: URDF files and mesh files (OBJ).
        target: the task file to write.
        position: position of the origin of the files in the world [m], shape ``(3,)``.
        force: whether an existing file is replaced.

    Raises:
        InputError: the task or a file has faults, the file exists or cannot be written, or bodies overlap.
    """
    check_new_file(target, "the task file", force=force)
    task = load_task(source)
    found = add_scene(task, files, position)
    save_task(found, target)
    return tuple(token.name for token in found.tokens[len(task.tokens) :])


def _read(path: Path) -> list[SceneBody]:
    suffix = path.suffix.lower()
    if suffix == ".urdf":
        return read_urdf(path)
    if suffix == ".obj":
        shape = read_mesh(path, MeshFile(kind="mesh", file=str(path)))
        return [SceneBody(path.stem, shape, np.zeros(3), _UPRIGHT)]
    wanted = "the name of a scene file must end in .urdf or .obj (Wavefront)"
    raise InputError([Issue(str(path), wanted, repr(suffix or path.name))])


def _free_name(name: str, taken: set[str]) -> str:
    """Return the name, or the name with the first number that makes it new."""
    if name not in taken:
        return name
    return next(each for number in range(2, len(taken) + 3) if (each := f"{name}-{number}") not in taken)
