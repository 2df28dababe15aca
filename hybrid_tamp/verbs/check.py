"""The verb ``check``: a task file goes in; every fault at once, each with its place, or the sound task comes out."""

from pathlib import Path

from hybrid_tamp.model.task import Task
from hybrid_tamp.verbs.loading import Settings, load


def check(source: Path | str, settings: Settings = Settings()) -> Task:  # noqa: B008
    """Check a task file, the planner that it names included, and return the task.

    Args:
        source: the path of a task file, or the name of a bundled task.
        settings: what replaces what the file says.

    Raises:
        InputError: something is wrong with the file; every fault has its place.
    """
    return load(source, settings, plans=True)
