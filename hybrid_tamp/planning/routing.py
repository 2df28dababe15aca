"""Evaluation of a plan in the forward models, with paths and an order for movements that would hit something."""

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from hybrid_tamp.collision.checker import DEPTH
from hybrid_tamp.midlevel.instance_model import Guard
from hybrid_tamp.midlevel.refinement import evaluate_defaults, refine
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.midlevel.summary import time_plan
from hybrid_tamp.model.collision import Collision
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.refined import CLEAR, ON_TOP, RefinedPlan, Shortfall
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.planning.clearance import Hit, Sweep, find_sweeps
from hybrid_tamp.planning.closest_pairs import find_closest_pairs
from hybrid_tamp.planning.collisions import check_plan
from hybrid_tamp.planning.detours import find_detour
from hybrid_tamp.planning.guards import make_guard
from hybrid_tamp.planning.meetings import find_meeting, put_in_order
from hybrid_tamp.planning.overhangs import Overhang, find_overhang
from hybrid_tamp.planning.proofs import prove_blocked

_LOG = logging.getLogger(__name__)

Evaluate = Callable[[TaskPlan, Rollouts], RefinedPlan]
"""Function of a plan and its rollouts that returns the plan with a value for every hyperparameter."""

_MOST_GUARDS = 4
"""Largest number of times that guards are added to one plan."""


@dataclass(frozen=True)
class _Attempt:
    """A plan to evaluate.

    Attributes:
        plan: the plan, with paths and an order for some movements.
        guards: maps movements that hit bodies with other hyperparameters to the distances that they must keep.
        extras: maps the same movements to further distances, see `make_guard` [m].
        refused: the evaluated plan in which the first of these movements hits a body. None if there are no guards.
        repeated: number of times that guards were added.
    """

    plan: TaskPlan
    guards: Mapping[str, Guard] = field(default_factory=dict)
    extras: Mapping[str, float] = field(default_factory=dict)
    refused: RefinedPlan | None = None
    repeated: int = 0

    def with_guard(self, task: Task, movement: Sweep, hit: Hit, refused: RefinedPlan) -> "_Attempt":
        """Return the attempt in which the hyperparameters are chosen so that a movement keeps its distance."""
        name = movement.instance.name
        extra = self.extras[name] - hit.margin if name in self.extras else 0.0
        guards = {**self.guards, name: make_guard(task, movement, extra)}
        return _Attempt(self.plan, guards, {**self.extras, name: extra}, self.refused or refused, self.repeated + 1)


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
    attempt = _Attempt(plan)
    while True:
        rollouts = Rollouts(task, attempt.plan, deadline, attempt.guards)
        refined = evaluate(attempt.plan, rollouts)
        missed = refined.shortfall
        if missed is not None and missed.atom.predicate != CLEAR:
            return attempt.refused or refined
        traces = rollouts.trace(refined.plan)
        movements = list(find_sweeps(task, refined.plan, traces, deadline))
        overhang = find_overhang(task, movements)
        if overhang is not None:
            return replace(refined, shortfall=_fall(overhang))
        changed = _avoid_bodies(task, refined, attempt, movements) or _avoid_meetings(task, refined, attempt, movements)
        if isinstance(changed, RefinedPlan):
            return changed
        if changed is None:
            found = refined if missed is None else _settle(task, refined, deadline)
            found = replace(found, closest_pairs=find_closest_pairs(movements))
            collisions = check_plan(task, time_plan(task, found.plan, rollouts), traces)
            return replace(found, shortfall=_collide(task, found.plan, collisions[0])) if collisions else found
        attempt = changed


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


def _avoid_bodies(
    task: Task, refined: RefinedPlan, attempt: _Attempt, movements: Sequence[Sweep]
) -> _Attempt | RefinedPlan | None:
    """Return the next attempt if a movement hits a body at rest, or the refused plan if nothing helps.

    The result is None if no movement hits a body.
    """
    for movement in movements:
        hit = movement.find_hit()
        if hit is None:
            continue
        name, moving, other = movement.instance.name, hit.nearest.moving, hit.nearest.other
        path, remark, proven = _find_way(task, movement)
        if path is not None:
            _LOG.info("%s follows a path with %d corners, because %s would hit %s", name, len(path), moving, other)
            return replace(attempt, plan=attempt.plan.with_path(name, path))
        if movement.ends_near(hit):
            remark = f"where the movement ends, {remark}" if proven else "where the movement ends"
        place, atom = movement.place_of(hit), Atom(CLEAR, (moving, other))
        shortfall = Shortfall(name, atom, "m", hit.margin, remark, place, proven, hit.kept)
        refused = replace(refined, shortfall=shortfall)
        varies = any(each.lower < each.upper for each in refined.hyperparameters)
        if proven or not varies or refined.shortfall is not None or attempt.repeated >= _MOST_GUARDS:
            return attempt.refused or refused
        _LOG.info("%s must keep its distance from bodies, because %s would hit %s", name, moving, other)
        return attempt.with_guard(task, movement, hit, refused)
    return None


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
    task: Task, refined: RefinedPlan, attempt: _Attempt, movements: Sequence[Sweep]
) -> _Attempt | RefinedPlan | None:
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
            return replace(attempt, plan=attempt.plan.with_order(first, second).retime(times))
    remark = "and neither movement can go first"
    return replace(refined, shortfall=Shortfall(other.instance.name, Atom(CLEAR, bodies), "m", 0.0, remark))


def route_defaults(task: Task, plan: TaskPlan, deadline: Deadline = NEVER) -> RefinedPlan | None:
    """Route a plan with the default hyperparameters, whose other shortfalls do not matter.

    The hyperparameters are optimised only if a movement hits a body and has no path.

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

    def evaluate(one: TaskPlan, rollouts: Rollouts) -> RefinedPlan:
        if rollouts.guards:
            return refine(task, one, roll_out=rollouts, compare=False, nearby=rollouts.guards, deadline=deadline)
        return replace(evaluate_defaults(task, one, rollouts), shortfall=None)

    return route(task, plan, evaluate, deadline)


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
