"""The whole symbolic stage: compile, ask the planner, decode, schedule, and judge before anyone sees the plan."""

import logging
from dataclasses import dataclass
from typing import Protocol

from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Limits, Task
from hybrid_tamp.symbolic.decoder import UndecodableError, decode
from hybrid_tamp.symbolic.makespan import shortened
from hybrid_tamp.symbolic.operators import PlannedAction, PlanningProblem
from hybrid_tamp.symbolic.pddl import action_line
from hybrid_tamp.symbolic.planner import PlannerAnswer
from hybrid_tamp.symbolic.problem import Compilation, compile_task
from hybrid_tamp.symbolic.schedule import InfeasibleScheduleError, schedule

SHORTENING = 20.0
"""How long a shorter plan is looked for when the objective is the makespan [s]."""

_LOG = logging.getLogger(__name__)


class Planner(Protocol):
    """Whatever answers a planning problem; `symbolic.planner.PlannerProcess` does."""

    def solve(self, problem: PlanningProblem, engine: str, limits: Limits) -> PlannerAnswer:
        """Return the engine's answer."""
        ...


@dataclass(frozen=True)
class Planned:
    """What came of asking a planner.

    Attributes:
        compilation: the compiled task.
        answer: the engine's own answer.
        plan: the checked timeline, or None.
        refusal: why the engine's plan was refused, or empty.
    """

    compilation: Compilation
    answer: PlannerAnswer
    plan: TaskPlan | None
    refusal: str = ""

    @property
    def status(self) -> str:
        """``solved``, ``unsolvable``, ``not_found``, ``planner_crashed`` or ``plan_refused``."""
        if self.plan is not None:
            return "solved"
        if self.refusal:
            return "plan_refused"
        return {"crashed": "planner_crashed", "refused": "plan_refused"}.get(self.answer.status, self.answer.status)


def plan_task(task: Task, planner: Planner) -> Planned:
    """Return a plan that the law checker and unified-planning's validator both passed, or why there is none.

    Args:
        task: the task.
        planner: a running planner process.

    Raises:
        InputError: the engine is not installed or not known, or the goal cannot be compiled.
        LimitReached: the engine ran into the time or memory limit.
    """
    compilation = compile_task(task)
    answer = planner.solve(compilation.problem, task.planner, task.limits)
    if answer.status != "solved":
        return Planned(compilation, answer, None)
    plan, refusal = _judged(compilation, answer.actions)
    if refusal:
        _LOG.warning("the plan of %s was refused: %s", answer.engine, refusal)
    return Planned(compilation, answer, plan, refusal)


def _judged(compilation: Compilation, actions: tuple[PlannedAction, ...]) -> tuple[TaskPlan | None, str]:
    try:
        instances = decode(compilation, actions)
        plan = schedule(compilation.task, instances, tuple(map(action_line, actions)))
    except (UndecodableError, InfeasibleScheduleError) as error:
        return None, str(error)
    if compilation.task.objective == "makespan":
        plan = shortened(compilation, plan, actions, SHORTENING)
    violations = check_law(compilation.task, plan)
    return (None, "; ".join(map(str, violations))) if violations else (plan, "")
