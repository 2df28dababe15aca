"""Proofs without safety factors. A fact that fails only because of its safety factor proves nothing."""

from dataclasses import replace

from hybrid_tamp.feasibility.safety_figures import describe_blocked, find_blocked
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.outcome import SAFETY, PlanningFailure, PlanOutcome
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.symbolic.strategies.search import Planner


def blame_factors(outcome: PlanOutcome, planner: Planner, deadline: Deadline) -> PlanOutcome:
    """Return an outcome of planning that is 'unsolvable' only if the physical bounds exclude every plan.

    If the facts exclude every plan, the task is planned again with physical bounds, i.e. with all safety factors at 1.
    If these facts do not exclude a plan, the failure is of the kind `SAFETY`, and its detail states the facts and their
    figures.

    Args:
        outcome: the outcome of planning a task with its safety factors.
        planner: a running planner process.
        deadline: deadline of the command.
    """
    task = outcome.task
    if outcome.status != "unsolvable":
        return outcome
    blocked = find_blocked(task)
    if not blocked:
        return outcome
    bare = task.with_safety(dict.fromkeys(task.domain.safety, 1.0))
    physical = plan_task(bare.replaced(objective="length"), planner, deadline)
    if physical.status == "unsolvable":
        return outcome
    if physical.status == "limit":
        return replace(outcome, failure=physical.failure)
    needed = _needed(bare, physical, blocked) or blocked
    return replace(outcome, failure=PlanningFailure(SAFETY, describe_blocked(task, needed)))


def _needed(task: Task, outcome: PlanOutcome, blocked: list[Atom]) -> list[Atom]:
    """Return the blocked facts that are entry conditions in the plan of an outcome. Empty if there is no plan."""
    instances = () if outcome.plan is None else outcome.plan.instances
    needed = {
        literal.ground(task.bind(instance.roles))
        for instance in instances
        for literal in task.domain.block_by_name[instance.block].static_entry
    }
    return [atom for atom in blocked if atom in needed]
