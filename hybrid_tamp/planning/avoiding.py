"""Changes of a plan whose movement hits a body at rest, or meets another movement.

A child process finds the changes, because the libraries for distances and paths may end their process (`isolation`).

The remedies are, in this order: a path around the body; a resting hand that gives way; other hyperparameters, with
which the movement keeps its distance. If the hand rests where the movement ends, it gives way first, because no path
helps. If two movements meet, one of them goes first.
"""

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from hybrid_tamp.midlevel.instance_model import Guard
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.refined import CHECKED, CLEAR, RefinedPlan, Shortfall
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.planning.clearance import Hit, Sweep, require_distance
from hybrid_tamp.planning.detours import find_detour
from hybrid_tamp.planning.giving_way import make_room, waiting_for
from hybrid_tamp.planning.guards import make_guard
from hybrid_tamp.planning.isolation import ChildEnded, Note, run_isolated
from hybrid_tamp.planning.key_poses import prove_overlap
from hybrid_tamp.planning.meetings import find_meeting, put_in_order
from hybrid_tamp.planning.proofs import prove_blocked

_LOG = logging.getLogger(__name__)

_MOST_GUARDS = 4
"""Largest number of times that guards are added to one plan."""


@dataclass(frozen=True)
class Attempt:
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

    def with_guard(self, task: Task, movement: Sweep, change: "_Change", refused: RefinedPlan) -> "Attempt":
        """Return the attempt in which the hyperparameters are chosen so that a movement keeps its distance."""
        name = movement.instance.name
        assert change.shortfall is not None
        extra = self.extras[name] - change.shortfall.margin if name in self.extras else 0.0
        guards = {**self.guards, name: make_guard(task, movement, [each + extra for each in change.distances])}
        return Attempt(self.plan, guards, {**self.extras, name: extra}, self.refused or refused, self.repeated + 1)


@dataclass(frozen=True)
class _Change:
    """What a child process found for a plan in which a movement hits something.

    Attributes:
        plan: the plan with a remedy, or None if there is none.
        shortfall: the reason to refuse the plan, or None if there is a remedy.
        movement: index of the movement that hits a body at rest. None if two movements meet.
        distances: distances that this movement must keep from its neighbours [m].
    """

    plan: TaskPlan | None = None
    shortfall: Shortfall | None = None
    movement: int | None = None
    distances: tuple[float, ...] = ()


def avoid_collisions(
    task: Task, refined: RefinedPlan, attempt: Attempt, movements: Sequence[Sweep], deadline: Deadline
) -> Attempt | RefinedPlan | None:
    """Return the next attempt if a movement hits something, or the refused plan if nothing helps.

    The result is None if no movement hits anything.

    Args:
        task: task of the plan.
        refined: the evaluated plan.
        attempt: the attempt whose plan was evaluated.
        movements: movements of the plan in the order of their starts.
        deadline: deadline of the command.

    Raises:
        LimitReached: the deadline passes.
    """
    try:
        change = run_isolated(partial(_find_change, task, refined, attempt.plan, movements), deadline)
    except ChildEnded as ended:
        return refuse_unchecked(refined, ended)
    if change is None:
        return None
    if change.plan is not None:
        return replace(attempt, plan=change.plan)
    refused = replace(refined, shortfall=change.shortfall)
    if change.movement is None:
        return refused
    varies = any(each.lower < each.upper for each in refined.hyperparameters)
    proven = change.shortfall is not None and change.shortfall.proven
    if proven or not varies or refined.shortfall is not None or attempt.repeated >= _MOST_GUARDS:
        return refused if proven else attempt.refused or refused
    movement = movements[change.movement]
    _LOG.info("%s must keep its distance from bodies", movement.instance.name)
    return attempt.with_guard(task, movement, change, refused)


def refuse_unchecked(refined: RefinedPlan, ended: ChildEnded) -> RefinedPlan:
    """Return a plan that is refused because a library ended its process while a movement was checked."""
    return replace(refined, shortfall=Shortfall(ended.doing, Atom(CHECKED, (ended.doing,)), "1", 0.0, ended.cause))


def _find_change(
    task: Task, refined: RefinedPlan, plan: TaskPlan, movements: Sequence[Sweep], note: Note
) -> _Change | None:
    # Movements without paths come first: if one of them cannot avoid a body, no path of another movement helps.
    for index in sorted(range(len(movements)), key=lambda each: _accepts_path(task, movements[each])):
        movement = movements[index]
        note(movement.instance.name)
        hit = movement.find_hit()
        if hit is not None:
            hopeless = _find_hopeless(task, movements)
            if hopeless is not None:
                return hopeless
            return replace(_avoid_body(task, refined, plan, movements, movement, hit), movement=index)
    return _avoid_meeting(task, refined, plan, movements, note)


def _find_hopeless(task: Task, movements: Sequence[Sweep]) -> _Change | None:
    """Return the reason why a movement of the plan cannot succeed, whatever its hyperparameters and paths are."""
    for index, movement in enumerate(movements):
        shortfall = prove_overlap(task, movement, movements[:index])
        if shortfall is not None:
            return _Change(shortfall=shortfall, movement=index)
    return None


def _avoid_body(
    task: Task,
    refined: RefinedPlan,
    plan: TaskPlan,
    movements: Sequence[Sweep],
    movement: Sweep,
    hit: Hit,
) -> _Change:
    name, other, ends_near = movement.instance.name, hit.nearest.other, movement.ends_near(hit)
    roomier = make_room(task, refined.plan, movements, movement, other) if ends_near else None
    if roomier is not None:
        return _Change(_reset(plan, roomier))
    path, remark, proven = _find_way(task, movements, movement)
    if path is not None:
        _LOG.info("%s follows a path with %d corners, because %s would be hit", name, len(path), other)
        return _Change(plan.with_path(name, path))
    roomier = None if ends_near else make_room(task, refined.plan, movements, movement, other)
    if roomier is not None:
        return _Change(_reset(plan, roomier))
    pairs = zip(movement.tracks, movement.neighbours, strict=True)
    distances = tuple(require_distance(track, each) for track, neighbours in pairs for each in neighbours)
    return _Change(shortfall=_describe(refined, movement, hit, remark, proven=proven), distances=distances)


def _describe(refined: RefinedPlan, movement: Sweep, hit: Hit, remark: str, *, proven: bool) -> Shortfall:
    """Return the reason why a movement hits a body. It names the movement for which a hand would have to give way."""
    if movement.ends_near(hit):
        remark = f"where the movement ends, {remark}" if proven else "where the movement ends"
    where = waiting_for(refined.plan, movement.instance.name)
    atom = Atom(CLEAR, (hit.nearest.moving, hit.nearest.other))
    return Shortfall(where, atom, "m", hit.margin, remark, movement.place_of(hit), proven, hit.kept)


def _reset(plan: TaskPlan, changed: TaskPlan) -> TaskPlan:
    """Return a changed plan with the hyperparameters that another plan has for the same instances."""
    values = {each.name: each.hyperparameters for each in plan.instances}
    instances = (replace(each, hyperparameters=values.get(each.name, {})) for each in changed.instances)
    return replace(changed, instances=tuple(instances))


def _find_way(task: Task, movements: Sequence[Sweep], movement: Sweep) -> tuple[FloatArray | None, str, bool]:
    """Return a path for a movement that hits a body, or why there is none, and whether this is proven."""
    accepts = _accepts_path(task, movement)
    if accepts and not movement.instance.path:
        path = find_detour(task, movement, _seed(task, movement.instance.name))
        if path is not None:
            return path, "", False
    proof = prove_blocked(task, movement, movements[: movements.index(movement)])
    return None, proof or ("and the search found no path around it" if accepts else ""), bool(proof)


def _accepts_path(task: Task, movement: Sweep) -> bool:
    return task.domain.block_by_name[movement.instance.block].path is not None


def _avoid_meeting(
    task: Task, refined: RefinedPlan, plan: TaskPlan, movements: Sequence[Sweep], note: Note
) -> _Change | None:
    """Return the plan in which one of two movements that meet goes first, or the reason if neither can go first."""
    found = find_meeting(task, refined.plan, movements, note)
    if found is None:
        return None
    one, other, bodies = found
    for first, second in ((one.instance.name, other.instance.name), (other.instance.name, one.instance.name)):
        ordered = put_in_order(task, refined.plan, first, second)
        if ordered is not None:
            _LOG.info("%s starts after %s, because %s meets %s on the way", second, first, *bodies)
            times = {each.name: (each.start, each.reached, each.end) for each in ordered.instances}
            return _Change(plan.with_order(first, second).retime(times))
    remark = "and neither movement can go first"
    return _Change(shortfall=Shortfall(other.instance.name, Atom(CLEAR, bodies), "m", 0.0, remark))


def _seed(task: Task, name: str) -> int:
    """Return the seed of the query for one instance."""
    return int(np.random.SeedSequence([task.seed, *name.encode()]).generate_state(1)[0])
