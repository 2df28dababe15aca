"""Load tasks from texts that are in no file."""

from pathlib import Path

from hybrid_tamp.model.task import Task
from hybrid_tamp.taskfile.domains import installed_domain
from hybrid_tamp.taskfile.loader import CheckPlanner, FindDomain, read_task
from hybrid_tamp.taskfile.yaml.nodes import parse


def load_task_text(
    text: str, name: str, find_domain: FindDomain = installed_domain, check_planner: CheckPlanner | None = None
) -> Task:
    """Return the task in a text, like `load_task` for a file. Messages show `name` as the file's name."""
    document = parse(text, name)
    return read_task(document.data, document.faults, name, Path(), find_domain, check_planner)
