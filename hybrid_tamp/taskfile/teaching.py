"""A task whose blocks are taught further motor primitives; its file says so, and all else in the file stays."""

import logging
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from hybrid_tamp.model.task import Task
from hybrid_tamp.taskfile.copying import portable
from hybrid_tamp.taskfile.loader import FindDomain, load_task
from hybrid_tamp.taskfile.primitives import PrimitiveFile

_logger = logging.getLogger(__name__)


def teach_task(task: Task, primitives: Mapping[str, PrimitiveFile], folder: Path, find_domain: FindDomain) -> Task:
    """Return the task with motor primitives, unless its file names primitives itself.

    Args:
        task: the task.
        primitives: block to the primitive that it is taught.
        folder: where the file of the new task and those that it names are written.
        find_domain: how the domain is found that the file names.

    Raises:
        InputError: a file cannot be read or written.
    """
    if not primitives:
        return task
    if task.primitives:
        _logger.warning("the task %s names primitives itself: nothing is taught", task.name)
        return task
    names = {name: f"primitive-{number:02d}.json" for number, name in enumerate(primitives, start=1)}
    for name, primitive in primitives.items():
        (folder / names[name]).write_text(primitive.text, encoding="utf-8")
    if task.source is None:
        blocks = [task.domain.block_by_name[name] for name in primitives]
        taught = [block.taught(primitives[block.name].primitive) for block in blocks if block.taught is not None]
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
