"""The verb ``check``: find all faults of a task file with their places."""

from pathlib import Path

from hybrid_tamp.model.task import Task
from hybrid_tamp.verbs.loading import Settings, load


def check(source: Path | str, settings: Settings = Settings()) -> Task:  # noqa: B008
    """Check a task file, including the name of its planner, and return the task.

    Args:
        source: the path of a task file, or the name of a bundled task.
        settings: settings that override the task file.

    Raises:
        InputError: the file has faults; each issue names the place of a fault.
    """
    return load(source, settings, plans=True)
