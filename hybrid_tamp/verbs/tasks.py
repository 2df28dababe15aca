"""The verb ``tasks``: list the bundled tasks."""

from hybrid_tamp.model.listings import BundledTask
from hybrid_tamp.taskfile.bundled import describe_bundled
from hybrid_tamp.taskfile.domains import bundled_tasks


def task_names() -> tuple[str, ...]:
    """Return the sorted names of the bundled tasks, without reading their files."""
    return bundled_tasks()


def list_tasks() -> list[BundledTask]:
    """Return the bundled tasks, sorted by name."""
    return describe_bundled()
