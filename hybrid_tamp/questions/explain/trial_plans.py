"""Trying changed tasks out: is there a plan, or is there proof that there is none?"""

import time
from contextlib import ExitStack
from dataclasses import replace
from itertools import cycle

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.task import DEFAULT_PLANNER, Task
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.strategies.relaxation import may_be_solvable
from hybrid_tamp.symbolic.strategies.stage import plan_task

LEAST = 2.0
"""A plan that is looked for shortly before the deadline has so long all the same [s]."""
PROVING = 10.0
"""How long it is tried to prove that there is no plan [s]."""


class Trying(ExitStack):
    """Plans changed tasks, until a deadline on the monotonic clock [s]."""

    def __init__(self, deadline: float) -> None:
        super().__init__()
        self._deadline = deadline
        # Processes answer once; so one starts while the other answers.
        self._processes = cycle(self.enter_context(PlannerProcess()) for _ in range(2))

    @property
    def over(self) -> bool:
        """Whether the deadline has passed."""
        return time.monotonic() > self._deadline

    def length(self, task: Task) -> int | None:
        """Return the number of actions of a plan, or None if none is found in time."""
        try:
            return self._tried(task, max(LEAST, self._deadline - time.monotonic()))
        except LimitReached:
            return None

    def excluded(self, task: Task) -> bool:
        """Say whether it is proven, in a short time, that there is no plan."""
        if not any(may_be_solvable(compile_task(each).problem) for each in task.alternatives()):
            return True
        try:
            return self._tried(task, PROVING) is None
        except LimitReached:
            return False

    def _tried(self, task: Task, seconds: float) -> int | None:
        limits = replace(task.limits, time=min(task.limits.time, seconds))
        # Any plan will do, so the engine is the one that ends where there is none.
        simple = task.replaced(objective="length", planner=DEFAULT_PLANNER, limits=limits)
        process = next(self._processes)
        try:
            planned = plan_task(simple, process)
        finally:
            process.prepare()
        return len(planned.plan.actions) if planned.plan else None
