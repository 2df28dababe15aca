"""Rounds of the task planner and the mid-level planner, until a plan can be carried out as far as the models tell.

The best hyperparameters may leave a condition unmet. Then nothing is executed: the binding of the block that fails is
forbidden and the task planner is asked again, so many times as the task's limits say.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

from hybrid_tamp.errors import InputError, NoPlan
from hybrid_tamp.midlevel.objective import RollOut
from hybrid_tamp.midlevel.plan_search import Progress
from hybrid_tamp.midlevel.refinement import refine
from hybrid_tamp.model.forbidding import forbid
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.refined import GOAL, RefinedPlan, Shortfall
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import PlanOutcome
from hybrid_tamp.report.plan_entries import ExplanationEntry, ReasonEntry

KIND = "not_refined"
_SAID = "Plans exist, but none was found that the blocks' own forward models can carry out."


@dataclass(frozen=True)
class Round:
    """A plan that was given up.

    Attributes:
        instance: the instance whose binding was forbidden then.
        shortfall: the condition that no hyperparameters meet.
    """

    instance: BlockInstance
    shortfall: Shortfall

    def __str__(self) -> str:
        roles = ", ".join(f"{role}={name}" for role, name in self.instance.roles.items())
        short = self.shortfall
        unit = "" if short.unit == "1" else f" {short.unit}"
        return f"{self.instance.block} with {roles}: {short.atom.text} fails by {-short.margin:.3g}{unit} at best"


@dataclass(frozen=True)
class Rounds:
    """What came of all rounds.

    Attributes:
        outcome: of the last one: the plan that is left, or why there is none.
        refined: its plan with optimised hyperparameters, or None.
        given_up: the plans before it.
    """

    outcome: PlanOutcome
    refined: RefinedPlan | None
    given_up: tuple[Round, ...]


def plan_in_rounds(
    task: Task,
    plan: Callable[[Task], PlanOutcome],
    progress: Progress | None = None,
    measure: Callable[[Task, TaskPlan], RollOut] | None = None,
) -> Rounds:
    """Plan a task and optimise its hyperparameters; where no hyperparameters do, plan anew.

    Args:
        task: the task.
        plan: the task planner.
        progress: told how far each optimisation is.
        measure: makes what runs candidates of a plan in physics, for tasks that ask for it.

    Raises:
        NotFinite: every rollout of a plan failed.
    """
    given_up: list[Round] = []
    current = task
    while True:
        outcome = plan(current)
        if outcome.plan is None:
            return Rounds(_ended(outcome, given_up), None, tuple(given_up))
        chosen = outcome.chosen or current
        refined = refine(chosen, outcome.plan, progress, measured=measure and measure(chosen, outcome.plan))
        if refined.shortfall is None:
            return Rounds(outcome, refined, tuple(given_up))
        failing = Round(_failing(current, outcome.plan, refined.shortfall), refined.shortfall)
        given_up.append(failing)
        try:
            current = forbid(current, failing.instance)
        except InputError as error:
            return Rounds(_ended(outcome, given_up, str(error)), None, tuple(given_up))
        if len(given_up) > task.limits.refinements:
            said = f"after {len(given_up)} plans the limit of {task.limits.refinements} refinements is reached"
            return Rounds(_ended(outcome, given_up, said), None, tuple(given_up))


def _failing(task: Task, plan: TaskPlan, shortfall: Shortfall) -> BlockInstance:
    """Return the instance to blame: whose condition it is, or the last one that was to bring a goal atom about."""
    if shortfall.where != GOAL:
        return next(instance for instance in plan.instances if instance.name == shortfall.where)
    last_first = sorted(plan.instances, key=lambda i: (i.end, i.start, i.name), reverse=True)
    for instance in last_first:
        block, roles = task.domain.block_by_name[instance.block], task.bind(instance.roles)
        if shortfall.atom in (literal.ground(roles) for literal in block.exit):
            return instance
    moving = [i for i in last_first if task.domain.block_by_name[i.block].moves]
    return (moving or last_first)[0]


def _ended(outcome: PlanOutcome, given_up: list[Round], detail: str = "") -> PlanOutcome:
    """Return the outcome of the last round as that of the whole: no plan is left that can be carried out."""
    if not given_up or (outcome.error is not None and not isinstance(outcome.error, NoPlan)):
        return outcome
    reasons = [
        ReasonEntry(
            goal=", ".join(map(str, outcome.task.goal)),
            block=each.instance.block,
            kind="forward models",
            message=str(each),
            atom=each.shortfall.atom.text,
            margin=each.shortfall.margin,
            unit=each.shortfall.unit,
        )
        for each in given_up
    ]
    said = " ".join(filter(None, [_SAID, detail and f"{detail[0].upper()}{detail[1:]}."]))
    explanation = ExplanationEntry(kind=KIND, message=said, reasons=reasons)
    document = outcome.document.model_copy(
        update={"status": "unknown", "explanation": explanation, "steps": [], "actions": [], "makespan": None}
    )
    message = "\n".join([said, *(f"  {each}" for each in given_up)])
    error = NoPlan(message, proven=False, kind=KIND)
    return replace(outcome, document=document, plan=None, error=error)
