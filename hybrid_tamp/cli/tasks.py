"""The verb ``tasks``."""

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say


def tasks(as_json: options.Json = False) -> None:
    """List the bundled tasks.

    Example: hybrid-tamp tasks
    """
    from hybrid_tamp.report.listings import tasks_document, tasks_table
    from hybrid_tamp.verbs.tasks import list_tasks

    found = list_tasks()
    say(tasks_document(found), as_json, lambda: tasks_table(found))
