"""Tasks as problems of unified_planning, and plans of unified_planning as plans of tasks.

The problem has the plain form (`symbolic.engines.plain`), so that every engine of unified_planning reads the same
problem. The functions import unified_planning when they are called, because the import is slow.
"""

from functools import cached_property
from typing import TYPE_CHECKING

from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.engines.plain import PlainProblem, without_impossible
from hybrid_tamp.symbolic.engines.unified import UnifiedProblem, unify
from hybrid_tamp.symbolic.exported import ExportedTask

if TYPE_CHECKING:
    from unified_planning.model import Problem
    from unified_planning.plans import Plan

_WHERE = "plan"


def to_unified_planning(task: Task) -> "Problem":
    """Return the planning problem of a task as a ``unified_planning.model.Problem``.

    The problem belongs to the global environment of unified_planning. There, `error_used_name` becomes False, because
    an object and an action may have the same name, and `credits_stream` becomes None. The names in the problem are PDDL
    names. `from_unified_planning` restores the user's names.

    Args:
        task: Task with a goal that leaves no choice. ``task.alternatives()`` lists the choices of a goal.

    Raises:
        InputError: If the goal has a negative atom, leaves a choice, or requires an `unknown` class of a token.
    """
    return _Exchange(task).unified.problem


def from_unified_planning(task: Task, plan: "Plan") -> TaskPlan:
    """Return a plan of `to_unified_planning(task)` as a plan of the task.

    Args:
        task: Task of the plan.
        plan: Sequential or partially ordered plan, e.g. ``planner.solve(problem).plan``. If a compiler of
            unified_planning changed the problem, first convert the plan back to a plan of the original problem.

    Returns:
        Plan in the user's names, with the earliest possible times. The validator of unified_planning has accepted the
        actions. The plan obeys the law of assignment and achieves the goal.

    Raises:
        InputError: If `plan` is not a plan of the task, or if the goal of the task cannot be compiled.
    """
    from unified_planning.exceptions import UPException
    from unified_planning.plans import Plan

    exchange = _Exchange(task)
    if not isinstance(plan, Plan):
        remedy = "pass the attribute `plan` of the engine's result, which is None if the engine found no plan"
        raise exchange.exported.refuse(_WHERE, type(plan).__name__, remedy=remedy)
    try:
        actions = exchange.unified.read_plan(plan)
    except UPException as error:
        raise exchange.exported.refuse(_WHERE, str(error)) from error
    if fault := exchange.unified.fault(actions):
        raise exchange.exported.refuse(_WHERE, fault)
    return exchange.exported.read_plan([exchange.plain.original(action) for action in actions], _WHERE)


class _Exchange:
    """A task in each of the forms between the task and the problem of unified_planning."""

    def __init__(self, task: Task) -> None:
        self.exported = ExportedTask.of(task)

    @cached_property
    def plain(self) -> PlainProblem:
        return PlainProblem(without_impossible(self.exported.compilation.problem))

    @cached_property
    def unified(self) -> UnifiedProblem:
        return unify(self.plain.problem)
