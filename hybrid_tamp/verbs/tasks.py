"""The verb ``tasks``: list the bundled tasks."""

from hybrid_tamp.model.listings import BundledTask
from hybrid_tamp.taskfile.bundled import describe_bundled


def list_tasks() -> list[BundledTask]:
    """Return the bundled tasks, sorted by name."""
    return describe_bundled()
