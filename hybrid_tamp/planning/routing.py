"""Evaluation of a plan in the forward models, with paths and an order for movements that would hit something."""

import logging
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from hybrid_tamp.collision.sweeps import Clearance
from hybrid_tamp.midlevel.refinement import evaluate_defaults
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.refined import CLEAR, ON_TOP, RefinedPlan, Shortfall
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.planning.clearance import Sweep, find_sweeps
from hybrid_tamp.planning.closest_pairs import find_closest_pairs
from hybrid_tamp.planning.detours import find_detour
from hybrid_tamp.planning.giving_way import make_room, waiting_for
from hybrid_tamp.planning.meetings import find_meeting, put_in_order
from hybrid_tamp.planning.overhangs import Overhang, find_overhang
from hybrid_tamp.planning.proofs import prove_blocked

_LOG = logging.getLogger(__name__)

Evaluate = Callable[[TaskPlan, Rollouts], RefinedPlan]
"""Function of a plan and its rollouts that returns the plan with a value for every hyperparameter."""


def route(task: Task, plan: TaskPlan, evaluate: Evaluate, deadline: Deadline = NEVER) -> RefinedPlan:
    """Evaluate a plan, and add paths around bodies and an order of movements, until no movement hits anything.

    If there is no path around a body, or if a body would leave the table on which it rests, the shortfall of the result
    names the body.

    Args:
        task: task of the plan.
        plan: a valid plan of the task.
        evaluate: function that chooses the hyperparameters.
        deadline: deadline of the command.

    Raises:
        LimitReached: the deadline passes.
        NotFinite: every rollout failed.
    """
    while True:
        rollouts = Rollouts(task, plan, deadline)
        refined = evaluate(plan, rollouts)
        if refined.shortfall is not None:
            where = waiting_for(refined.plan, refined.shortfall.where)
            return replace(refined, shortfall=replace(refined.shortfall, where=where))
        movements = list(find_sweeps(task, refined.plan, rollouts.trace(refined.plan), deadline))
        overhang = find_overhang(task, movements)
        if overhang is not None:
            return replace(refined, shortfall=_fall(overhang))
        changed = _avoid_bodies(task, refined, plan, movements) or _avoid_meetings(task, refined, plan, movements)
        if changed is None:
            return replace(refined, closest_pairs=find_closest_pairs(movements))
        if isinstance(changed, Shortfall):
            return replace(refined, shortfall=changed)
        plan = changed


def _fall(overhang: Overhang) -> Shortfall:
    """Return the reason why a body must not move beyond the edge of its table."""
    atom = Atom(ON_TOP, (overhang.thing, overhang.table))
    x, y, z = (float(each) for each in overhang.place)
    return Shortfall(overhang.instance, atom, "m", -overhang.beyond, place=(x, y, z))


def _avoid_bodies(
    task: Task, refined: RefinedPlan, plan: TaskPlan, movements: Sequence[Sweep]
) -> TaskPlan | Shortfall | None:
    """Return the plan in which the first movement that hits a body at rest avoids it, or the reason if it cannot."""
    for movement in movements:
        hit = movement.find_hit()
        if hit is not None:
            return _avoid(task, refined, plan, movements, movement, hit)
    return None


def _avoid(
    task: Task,
    refined: RefinedPlan,
    plan: TaskPlan,
    movements: Sequence[Sweep],
    movement: Sweep,
    hit: Clearance,
) -> TaskPlan | Shortfall:
    """Return the plan with a path for a movement, or in which a resting hand gives way, or the reason if neither helps.

    If the hand rests where the movement ends, no path helps.
    """
    name, ends_inside = movement.instance.name, movement.ends_inside(hit)
    make_way = partial(make_room, task, refined.plan, movements, movement, hit.other)
    changed = make_way() if ends_inside else None
    if changed is None:
        path, remark, proven = _find_way(task, movement)
        if path is not None:
            _LOG.info(
                "%s follows a path with %d corners, because %s would hit %s", name, len(path), hit.moving, hit.other
            )
            return plan.with_path(name, path)
        changed = None if ends_inside else make_way()
    if changed is not None:
        values = {each.name: each.hyperparameters for each in plan.instances}
        instances = (replace(each, hyperparameters=values.get(each.name, {})) for each in changed.instances)
        return replace(changed, instances=tuple(instances))
    if ends_inside:
        remark = f"where the movement ends, {remark}" if proven else "where the movement ends"
    where = waiting_for(refined.plan, name)
    return Shortfall(
        where, Atom(CLEAR, (hit.moving, hit.other)), "m", hit.distance, remark, movement.place_of(hit), proven
    )


def _find_way(task: Task, movement: Sweep) -> tuple[FloatArray | None, str, bool]:
    """Return a path for a movement that hits a body, or why there is none, and whether this is proven."""
    accepts = task.domain.block_by_name[movement.instance.block].path is not None
    if accepts and not movement.instance.path:
        path = find_detour(task, movement, _seed(task, movement.instance.name))
        if path is not None:
            return path, "", False
    proof = prove_blocked(task, movement)
    return None, proof or ("and the search found no path around it" if accepts else ""), bool(proof)


def _avoid_meetings(
    task: Task, refined: RefinedPlan, plan: TaskPlan, movements: Sequence[Sweep]
) -> TaskPlan | Shortfall | None:
    """Return the plan in which one of two movements that meet goes first, or the reason if neither can go first."""
    found = find_meeting(task, refined.plan, movements)
    if found is None:
        return None
    one, other, bodies = found
    for first, second in ((one.instance.name, other.instance.name), (other.instance.name, one.instance.name)):
        ordered = put_in_order(task, refined.plan, first, second)
        if ordered is not None:
            _LOG.info("%s starts after %s, because %s meets %s on the way", second, first, *bodies)
            times = {each.name: (each.start, each.reached, each.end) for each in ordered.instances}
            return plan.with_order(first, second).retime(times)
    return Shortfall(other.instance.name, Atom(CLEAR, bodies), "m", 0.0, "and neither movement can go first")


def route_defaults(task: Task, plan: TaskPlan, deadline: Deadline = NEVER) -> RefinedPlan | None:
    """Route a plan with the default hyperparameters, whose other shortfalls do not matter.

    Args:
        task: task of the plan.
        plan: a valid plan of the task.
        deadline: deadline of the command.

    Returns:
        The routed plan. None if the plan moves every body, so that there is nothing to avoid.

    Raises:
        LimitReached: the deadline passes.
        NotFinite: every rollout failed.
    """
    if not _leaves_bodies(task, plan):
        return None
    return route(
        task, plan, lambda one, rolled: replace(evaluate_defaults(task, one, rolled), shortfall=None), deadline
    )


def _leaves_bodies(task: Task, plan: TaskPlan) -> bool:
    """Return whether the task has a body that no instance of the plan moves."""
    blocks = task.domain.block_by_name
    moved = {
        token
        for instance in plan.instances
        for slot, token in instance.slots.items()
        if blocks[instance.block].writes.get(slot)
    }
    return any(token.shape is not None and token.name not in moved for token in task.tokens)


def _seed(task: Task, name: str) -> int:
    """Return the seed of the query for one instance."""
    return int(np.random.SeedSequence([task.seed, *name.encode()]).generate_state(1)[0])
