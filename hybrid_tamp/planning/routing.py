"""Evaluation of a plan in the forward models, with changes of the plan until no movement hits anything."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from hybrid_tamp.collision.checker import DEPTH
from hybrid_tamp.midlevel.refinement import evaluate_defaults, refine
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.midlevel.summary import time_plan
from hybrid_tamp.model.closest_pair import ClosestPair
from hybrid_tamp.model.collision import Collision
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.refined import CLEAR, ON_TOP, RefinedPlan, Shortfall
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.avoiding import Attempt, avoid_collisions, refuse_unchecked
from hybrid_tamp.planning.clearance import Sweep, find_sweeps
from hybrid_tamp.planning.closest_pairs import find_closest_pairs
from hybrid_tamp.planning.collisions import check_plan
from hybrid_tamp.planning.courses import may_collide
from hybrid_tamp.planning.giving_way import waiting_for
from hybrid_tamp.planning.isolation import ChildEnded, Note, run_isolated
from hybrid_tamp.planning.overhangs import Overhang, find_overhang

Evaluate = Callable[[TaskPlan, Rollouts], RefinedPlan]
"""Function of a plan and its rollouts that returns the plan with a value for every hyperparameter."""


def route(task: Task, plan: TaskPlan, evaluate: Evaluate, deadline: Deadline = NEVER) -> RefinedPlan:
    """Evaluate a plan until no movement hits anything. Movements get paths around bodies, and an order.

    If a movement hits a body and has no path, the hyperparameters are chosen again so that it keeps its distance. If
    this is impossible, or if a body would leave the table on which it rests, the shortfall of the result names the
    body.

    Args:
        task: task of the plan.
        plan: a valid plan of the task.
        evaluate: function that chooses the hyperparameters.
        deadline: deadline of the command.

    Raises:
        LimitReached: the deadline passes.
        NotFinite: every rollout failed.
    """
    attempt = Attempt(plan)
    while True:
        rollouts = Rollouts(task, attempt.plan, deadline, attempt.guards)
        refined = evaluate(attempt.plan, rollouts)
        missed = refined.shortfall
        failed = missed is not None and missed.atom.predicate != CLEAR
        if missed is not None and failed and not _may_take_path(task, refined.plan, missed):
            return attempt.refused or _refuse(refined, missed)
        movements = list(find_sweeps(task, refined.plan, rollouts.trace(refined.plan), deadline))
        overhang = find_overhang(task, movements)
        if overhang is not None:
            return replace(refined, shortfall=_fall(overhang))
        changed = avoid_collisions(task, refined, attempt, movements, deadline)
        if missed is not None and failed and not (isinstance(changed, Attempt) and changed.plan is not attempt.plan):
            return attempt.refused or _refuse(refined, missed)
        if isinstance(changed, RefinedPlan):
            return changed
        if changed is None:
            found = refined if missed is None else _settle(task, refined, deadline)
            return _check(task, found, rollouts, movements, deadline)
        attempt = changed


def _may_take_path(task: Task, plan: TaskPlan, missed: Shortfall) -> bool:
    """Return whether a path may also meet a condition that fails, e.g. because a hand begins under a table."""
    failing = next((each for each in plan.instances if each.name == missed.where), None)
    return failing is not None and not failing.path and task.domain.block_by_name[failing.block].path is not None


def _refuse(refined: RefinedPlan, missed: Shortfall) -> RefinedPlan:
    """Return a refused plan. If a hand fails to give way, the reason names the instance that waits for the hand."""
    return replace(refined, shortfall=replace(missed, where=waiting_for(refined.plan, missed.where)))


def _check(
    task: Task, found: RefinedPlan, rollouts: Rollouts, movements: Sequence[Sweep], deadline: Deadline
) -> RefinedPlan:
    """Return a plan with its closest pairs, or a refused plan if the independent check finds a collision."""
    timed, traces = time_plan(task, found.plan, rollouts), {each.instance.name: each.trace for each in movements}

    def check(note: Note) -> tuple[tuple[ClosestPair, ...], tuple[Collision, ...]]:
        note(movements[0].instance.name)
        return find_closest_pairs(movements), check_plan(task, timed, traces)

    if not movements:
        return found
    try:
        pairs, collisions = run_isolated(check, deadline)
    except ChildEnded as ended:
        return refuse_unchecked(found, ended)
    found = replace(found, closest_pairs=pairs)
    return replace(found, shortfall=_collide(task, found.plan, collisions[0])) if collisions else found


def _settle(task: Task, refined: RefinedPlan, deadline: Deadline) -> RefinedPlan:
    """Return a plan without the conditions of its guards, which are a little too strict."""
    settled = evaluate_defaults(task, refined.plan, Rollouts(task, refined.plan, deadline))
    return replace(refined, plan=settled.plan, best=settled.best, shortfall=settled.shortfall)


def _collide(task: Task, plan: TaskPlan, collision: Collision) -> Shortfall:
    """Return the reason why a plan is refused that the independent check refutes."""
    blocks = {each.name: task.domain.block_by_name[each.block] for each in plan.instances}
    names = [name for name in collision.instances if name]
    where = next((name for name in names if blocks[name].moves), names[0])
    remark = f"which only the check of the whole plan found at {collision.time:.2f} s"
    return Shortfall(where, Atom(CLEAR, collision.tokens), "m", -DEPTH, remark)


def _fall(overhang: Overhang) -> Shortfall:
    """Return the reason why a body must not move beyond the edge of its table."""
    atom = Atom(ON_TOP, (overhang.thing, overhang.table))
    x, y, z = (float(each) for each in overhang.place)
    return Shortfall(overhang.instance, atom, "m", -overhang.beyond, place=(x, y, z))


def route_defaults(task: Task, plan: TaskPlan, deadline: Deadline = NEVER) -> RefinedPlan | None:
    """Route a plan with the default hyperparameters, whose other shortfalls do not matter.

    The hyperparameters are optimised only if a movement hits a body and has no path.

    Args:
        task: task of the plan.
        plan: a valid plan of the task.
        deadline: deadline of the command.

    Returns:
        The routed plan. None if no movement comes near anything, as far as the courses of the blocks tell.

    Raises:
        LimitReached: the deadline passes.
        NotFinite: every rollout failed.
    """
    if not may_collide(task, plan, deadline):
        return None

    def evaluate(one: TaskPlan, rollouts: Rollouts) -> RefinedPlan:
        if rollouts.guards:
            return refine(task, one, roll_out=rollouts, compare=False, nearby=rollouts.guards, deadline=deadline)
        return replace(evaluate_defaults(task, one, rollouts), shortfall=None)

    return route(task, plan, evaluate, deadline)
