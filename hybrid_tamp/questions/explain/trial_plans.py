"""Trial planning of a limited number of changed tasks."""

from contextlib import ExitStack
from itertools import cycle

from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.engines.registry import FIRST
from hybrid_tamp.symbolic.find_plan import find_plan
from hybrid_tamp.symbolic.relaxation import may_be_solvable
from hybrid_tamp.symbolic.strategies.search import SearchResult


class TrialPlanner(ExitStack):
    """A planner for a limited number of changed tasks.

    The limit is a count and not a time, so that the result does not depend on the speed of the computer.

    Attributes:
        left: number of tasks that can still be planned.
        deadline: deadline of the command.
    """

    def __init__(self, most: int, deadline: Deadline = NEVER) -> None:
        super().__init__()
        self.left = most
        self.deadline = deadline
        # Each process plans one task. The second process starts while the first one searches.
        self._processes = cycle(self.enter_context(PlannerProcess()) for _ in range(2))

    @property
    def over(self) -> bool:
        """Whether the count is used up."""
        return self.left <= 0

    def length(self, task: Task) -> int | None:
        """Return the number of actions of a plan for the task, or None if no plan is found.

        Raises:
            LimitReached: a time or memory limit is reached.
        """
        plan = self._plan(task).plan
        return None if plan is None else len(plan.actions)

    def proves_unsolvable(self, task: Task) -> bool:
        """Say whether the delete relaxation or the planner proves that the task has no plan.

        The planner is not called if the count is used up.

        Raises:
            LimitReached: a time or memory limit is reached.
        """
        self.deadline.check()
        if not any(may_be_solvable(compile_task(each).problem) for each in task.alternatives()):
            return True
        return not self.over and self._plan(task).status == "unsolvable"

    def _plan(self, task: Task) -> SearchResult:
        self.left -= 1
        # Any plan is enough. This engine also terminates on unsolvable tasks.
        simple = task.replaced(objective="length", planner=FIRST)
        process = next(self._processes)
        planned = find_plan(simple, process, self.deadline)
        process.prepare()
        return planned
