"""Reader of plans that other planners found for exported PDDL files."""

import re
from pathlib import Path

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.plan import PlannedAction, TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.exported import ExportedTask

_ACTION = re.compile(r"\(\s*([^()\s]+(?:\s+[^()\s]+)*)\s*\)")


def read_plan(task: Task, path: Path | str) -> TaskPlan:
    """Read a plan that another planner found for the exported PDDL of a task.

    Args:
        task: Task whose ``domain.pddl`` and ``problem.pddl`` were given to the planner.
        path: Path of the plan file. Each line has one action ``(name argument ...)``. Comments start with ``;``.

    Returns:
        Plan with the earliest possible times. The plan obeys the law of assignment and achieves the goal.

    Raises:
        InputError: If the file cannot be read, or if its actions are not a plan of the task.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError([Issue(str(path), "expected a readable plan file", str(error))]) from error
    actions = [action for line in text.splitlines() for action in _parse_line(line)]
    return ExportedTask.of(task).read_plan(actions, str(path))


def _parse_line(line: str) -> list[PlannedAction]:
    """Return the actions in a line of text. All names become lower case, because PDDL ignores case."""
    found = _ACTION.findall(line.partition(";")[0].lower())
    actions = [words.split() for words in found]
    return [PlannedAction(name, tuple(arguments)) for name, *arguments in actions]
