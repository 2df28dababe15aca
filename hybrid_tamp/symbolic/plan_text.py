"""Reader of plans that other planners found for exported PDDL files."""

import re
from pathlib import Path

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import PlannedAction, TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import NotAPlanError
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.encoding.task_words import settle_goal
from hybrid_tamp.symbolic.schedule import schedule_actions
from hybrid_tamp.symbolic.whereabouts.export import encoded_task
from hybrid_tamp.symbolic.whereabouts.situate import Situation

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
    compilation = compile_task(encoded_task(settle_goal(task))[0])
    actions = [action for line in text.splitlines() for action in _parse_line(line)]
    wanted = f"expected a plan of the task {task.name}"
    if not compilation.reaches_goal(actions):
        came = "actions that cannot be applied in this order or do not achieve the goal"
        raise InputError([Issue(str(path), wanted, came)])
    try:
        plan = schedule_actions(compilation, actions)
    except NotAPlanError as error:
        raise InputError([Issue(str(path), wanted, str(error))]) from error
    plan = Situation(task).original_plan(plan)
    breaches = check_law(task, plan)
    if breaches:
        raise InputError([Issue(str(path), wanted, breach.text) for breach in breaches])
    return plan


def _parse_line(line: str) -> list[PlannedAction]:
    """Return the actions in a line of text. All names become lower case, because PDDL ignores case."""
    found = _ACTION.findall(line.partition(";")[0].lower())
    actions = [words.split() for words in found]
    return [PlannedAction(name, tuple(arguments)) for name, *arguments in actions]
