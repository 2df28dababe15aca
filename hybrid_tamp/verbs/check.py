"""The verb ``check``: find all faults of a task file, each with its place."""

from pathlib import Path

from hybrid_tamp.model.task import Task
from hybrid_tamp.verbs.loading import Settings, load


def check(source: Path | str, settings: Settings = Settings()) -> Task:  # noqa: B008
    """Check a task file and the name of its planner, and return the task.

    Args:
        source: the path of a task file, or the name of a bundled task.
        settings: settings that replace those of the task file.

    Raises:
        InputError: the file has faults; each issue has its place.
    """
    return load(source, settings, plans=True)
