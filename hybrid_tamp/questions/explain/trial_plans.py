"""Trial planning of changed tasks with a deadline."""

import time
from contextlib import ExitStack
from dataclasses import replace
from itertools import cycle

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.task import DEFAULT_PLANNER, Task
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.find_plan import find_plan
from hybrid_tamp.symbolic.relaxation import may_be_solvable

LEAST = 2.0
"""Smallest time limit of a search, in seconds. It applies even if less time remains until the deadline."""
PROVING = 10.0
"""Time limit of one attempt to prove that a task has no plan, in seconds."""


class TrialPlanner(ExitStack):
    """A planner for changed tasks with a deadline. The deadline is in seconds on the monotonic clock."""

    def __init__(self, deadline: float) -> None:
        super().__init__()
        self._deadline = deadline
        # Each process plans one task. The second process starts while the first process searches.
        self._processes = cycle(self.enter_context(PlannerProcess()) for _ in range(2))

    @property
    def over(self) -> bool:
        """Whether the deadline has passed."""
        return time.monotonic() > self._deadline

    def length(self, task: Task) -> int | None:
        """Return the number of actions of a plan for the task, or None if no plan is found in time."""
        try:
            return self._search(task, max(LEAST, self._deadline - time.monotonic()))
        except LimitReached:
            return None

    def proves_unsolvable(self, task: Task) -> bool:
        """Return whether a short search proves that the task has no plan."""
        if not any(may_be_solvable(compile_task(each).problem) for each in task.alternatives()):
            return True
        try:
            return self._search(task, PROVING) is None
        except LimitReached:
            return False

    def _search(self, task: Task, seconds: float) -> int | None:
        limits = replace(task.limits, time=min(task.limits.time, seconds))
        # Any plan is enough. The default engine also terminates on unsolvable tasks.
        simple = task.replaced(objective="length", planner=DEFAULT_PLANNER, limits=limits)
        process = next(self._processes)
        try:
            planned = find_plan(simple, process)
        finally:
            process.prepare()
        return len(planned.plan.actions) if planned.plan else None
