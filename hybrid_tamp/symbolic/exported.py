"""A task as other planners receive it, and the check of the plans that they find."""

from collections.abc import Sequence
from dataclasses import dataclass

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import PlannedAction, TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import NotAPlanError
from hybrid_tamp.symbolic.encoding.problem import Compilation, compile_task
from hybrid_tamp.symbolic.encoding.task_words import settle_goal
from hybrid_tamp.symbolic.schedule import schedule_actions
from hybrid_tamp.symbolic.whereabouts.export import encoded_task
from hybrid_tamp.symbolic.whereabouts.situate import Situation


@dataclass(frozen=True, eq=False)
class ExportedTask:
    """A task whose planning problem is given to another planner.

    Attributes:
        task: Task to plan, with a ground goal.
        compilation: Compiled task, which contains the whereabouts of tokens if the task needs them.
    """

    task: Task
    compilation: Compilation

    @classmethod
    def of(cls, task: Task) -> "ExportedTask":
        """Compile a task for another planner.

        Raises:
            InputError: If the goal has a negative atom, leaves a choice, or requires an `unknown` class of a token.
        """
        task = settle_goal(task)
        return cls(task, compile_task(encoded_task(task)[0]))

    def read_plan(self, actions: Sequence[PlannedAction], where: str) -> TaskPlan:
        """Return the plan with the earliest possible times. The plan obeys the law of assignment and achieves the goal.

        Args:
            actions: Actions that the other planner found, with PDDL names.
            where: Place of the actions, for messages.

        Raises:
            InputError: If the actions are not a plan of the task.
        """
        if not self.compilation.reaches_goal(actions):
            raise self.refuse(where, "actions that cannot be applied in this order or do not achieve the goal")
        try:
            plan = schedule_actions(self.compilation, actions)
        except NotAPlanError as error:
            raise self.refuse(where, str(error)) from error
        plan = Situation(self.task).original_plan(plan)
        breaches = check_law(self.task, plan)
        if breaches:
            raise self.refuse(where, *(breach.text for breach in breaches))
        return plan

    def refuse(self, where: str, *came: str, remedy: str = "") -> InputError:
        """Return the error for something that is not a plan of the task. `came` has one message per fault."""
        wanted = f"expected a plan of the task {self.task.name}"
        return InputError([Issue(where, wanted, each, remedy=remedy) for each in came])
