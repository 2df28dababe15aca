"""Planning, optimisation of the plan, and replanning if no hyperparameters meet all conditions of the plan.

If a condition fails even with the best hyperparameters, the binding of the failing block is excluded and the task
planner runs again. ``task.limits.refinements`` limits the number of repetitions.
"""

import logging
from collections.abc import Callable
from dataclasses import replace
from functools import reduce

from hybrid_tamp.errors import InputError, LimitReached
from hybrid_tamp.midlevel.refinement import refine
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.forbidding import forbid
from hybrid_tamp.model.outcome import BLOCKED, NOT_REFINED, Exclusion, PlanningFailure, PlanOutcome
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.refined import GOAL, Milestone, RefinedPlan, Shortfall
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.equal_hands import swap_equal_hands
from hybrid_tamp.planning.physics_rollouts import PhysicsRollouts
from hybrid_tamp.planning.routing import route, route_defaults
from hybrid_tamp.symbolic.whereabouts.predicted import predict_states
from hybrid_tamp.workers.processes import count_processors

_LOG = logging.getLogger(__name__)

FindPlan = Callable[[Task], PlanOutcome]
"""Function that plans a task, for example a task planner or the transfer of a demonstrated plan."""
Progress = Callable[[float, str], None]
"""Progress callback. Its arguments are the fraction of the work that is done (0 to 1) and a description."""


def plan_and_refine(
    task: Task,
    find_plan: FindPlan,
    progress: Progress | None = None,
    backend: str = "pybullet",
    processes: int | None = None,
    deadline: Deadline = NEVER,
) -> PlanOutcome:
    """Plan a task, optimise and route the whole plan, and replan without the failing bindings until a plan succeeds.

    Args:
        task: the task to plan.
        find_plan: the task planner.
        progress: called with the fraction of an optimisation that is done and its best value so far.
        backend: name of the physics backend for tasks with ``refine: physics``.
        processes: number of physics processes, by default one per processor. The result does not depend on the number.
        deadline: deadline of the command. If it passes, the outcome is a failure with the plan that was found before.

    Raises:
        InputError: if the planner or the backend is unknown.
        NotFinite: if every rollout of a plan fails.
    """
    workers = processes or count_processors()

    def optimise(outcome: PlanOutcome, plan: TaskPlan) -> RefinedPlan:
        return _optimise(outcome, plan, progress, backend, workers, deadline)

    def accept(outcome: PlanOutcome, refined: RefinedPlan) -> PlanOutcome:
        return replace(outcome, plan=refined.plan, refinement=refined, closest_pairs=refined.closest_pairs)

    return _replan(find_plan(task), find_plan, optimise, accept)


def avoid_collisions(outcome: PlanOutcome, find_plan: FindPlan, deadline: Deadline = NEVER) -> PlanOutcome:
    """Give paths and an order to the movements of a plan, and replan until no movement hits anything.

    The hyperparameters keep their defaults, and only collisions make a plan fail. A plan is rolled out only if its
    movements may come near something. The plan remains unchanged if nothing is in the way.

    Args:
        outcome: outcome of the task planner.
        find_plan: the task planner.
        deadline: deadline of the command.

    Raises:
        NotFinite: if the rollout of a plan fails.
    """

    def evaluate(outcome: PlanOutcome, plan: TaskPlan) -> RefinedPlan | None:
        return route_defaults(outcome.chosen or outcome.task, plan, deadline)

    def accept(outcome: PlanOutcome, refined: RefinedPlan) -> PlanOutcome:
        changed = refined.plan.order or refined.optimiser or any(each.path for each in refined.plan.instances)
        plan = refined.plan if changed else outcome.plan
        return replace(outcome, plan=plan, closest_pairs=refined.closest_pairs)

    return _replan(outcome, find_plan, evaluate, accept)


def _replan(
    outcome: PlanOutcome,
    find_plan: FindPlan,
    evaluate: Callable[[PlanOutcome, TaskPlan], RefinedPlan | None],
    accept: Callable[[PlanOutcome, RefinedPlan], PlanOutcome],
) -> PlanOutcome:
    """Evaluate a plan, and replan without the failing binding until a plan succeeds or cannot be evaluated."""
    excluded: tuple[Exclusion, ...] = ()
    current, most = outcome.task, outcome.task.limits.refinements
    while True:
        if excluded:
            outcome = replace(outcome, excluded=excluded, planner=outcome.planner.unproven)
        if outcome.plan is None or outcome.failure is not None:
            return _give_up(outcome) if excluded and outcome.status != "limit" else outcome
        try:
            refined = evaluate(outcome, outcome.plan)
        except LimitReached as limit:
            return replace(outcome, failure=PlanningFailure.of(limit))
        if refined is None or refined.shortfall is None:
            return outcome if refined is None else accept(outcome, refined)
        planned = outcome.plan
        failing = _failing_instance(current, planned, refined.shortfall)
        _LOG.info("the plan is refused, because in %s, %s", failing.name, refined.shortfall.text)
        excluded = (*excluded, Exclusion(failing, refined.shortfall, refined.plan))
        outcome = replace(outcome, excluded=excluded)
        try:
            current = _exclude(outcome.chosen or current, current, planned, failing, refined.shortfall)
        except InputError as error:
            return _give_up(outcome, str(error))
        if len(excluded) > most:
            said = f"the limit of {most} refinements is reached (excluded bindings: {len(excluded)})"
            return _give_up(outcome, said)
        outcome = find_plan(current)


def _optimise(
    outcome: PlanOutcome,
    plan: TaskPlan,
    progress: Progress | None,
    backend: str,
    processes: int,
    deadline: Deadline,
) -> RefinedPlan:
    def tell(share: float, best: Milestone) -> None:
        if progress is not None:
            said = f"V {best.violation:.3g}" if best.violation > 0 else f"value {best.value:.4g}"
            progress(share, f"optimising: {said}")

    task = outcome.chosen or outcome.task

    def choose(one: TaskPlan, rollouts: Rollouts) -> RefinedPlan:
        measured = PhysicsRollouts(task, one, backend, processes, deadline)
        return refine(task, one, tell, rollouts, measured=measured, nearby=rollouts.guards, deadline=deadline)

    return route(task, plan, choose, deadline)


def _failing_instance(task: Task, plan: TaskPlan, shortfall: Shortfall) -> BlockInstance:
    """Return the instance to exclude.

    If an entry or exit condition fails, return its instance. If a goal atom fails, return the last instance that should
    achieve the atom.
    """
    if shortfall.where != GOAL:
        return next(instance for instance in plan.instances if instance.name == shortfall.where)
    last_first = sorted(plan.instances, key=lambda i: (i.end, i.start, i.name), reverse=True)
    for instance in last_first:
        block, roles = task.domain.block_by_name[instance.block], task.bind(instance.roles)
        if shortfall.atom in (literal.ground(roles) for literal in block.exit):
            return instance
    moving = [i for i in last_first if task.domain.block_by_name[i.block].moves]
    return (moving or last_first)[0]


def _exclude(planned: Task, current: Task, plan: TaskPlan, failing: BlockInstance, shortfall: Shortfall) -> Task:
    """Return the current task without a failing binding in the situation in which the binding failed.

    The situation consists of the expected poses of the tokens that blocks move. In this situation, the same movement
    with other hands that are equal fails as well.

    Raises:
        InputError: if the block has too many bindings.
    """
    block = current.domain.block_by_name[failing.block]
    state = predict_states(planned, plan)[failing.name]
    moved = [role for role in block.roles if _is_moved(current, failing.roles[role])]
    equal = swap_equal_hands(current, failing, shortfall) if moved else [failing]
    return reduce(lambda task, each: forbid(task, each, state, moved, shortfall.wherever), equal, current)


def _is_moved(task: Task, name: str) -> bool:
    """Return whether some block moves a token that cannot move itself."""
    token = task.token_by_name.get(name)
    return token is not None and not token.place and not token.basic_actions and bool(task.domain.moving_slots(token))


def _give_up(outcome: PlanOutcome, detail: str = "") -> PlanOutcome:
    """Return the last outcome as a failure, because no executable plan remains.

    The failure is proven if the task without the excluded bindings certainly has no plan, and each exclusion is proven.
    """
    sentence = f"{detail[0].upper()}{detail[1:]}." if detail else ""
    proven = outcome.status == "unsolvable" and all(each.shortfall.proven for each in outcome.excluded)
    failure = PlanningFailure(BLOCKED if proven else NOT_REFINED, sentence)
    return replace(outcome, plan=None, chosen=None, failure=failure)
