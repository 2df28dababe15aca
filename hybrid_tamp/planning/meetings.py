"""Movements of different instances that would meet, and the order that keeps them apart.

Scheduled instants are estimates. So two movements are compared along their whole paths if the order of the
reassignments allows them to overlap at all. Only movements that start in one reassignment are compared instant by
instant. If two movements meet, one of them goes first.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations

from hybrid_tamp.collision.meetings import meet, meet_together
from hybrid_tamp.collision.sweeps import Track
from hybrid_tamp.model.contacts import ContactRules
from hybrid_tamp.model.grasp import pass_through
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.precedence import Precedence, must_wait
from hybrid_tamp.model.reassignment import Reassignment, initial, reassignments
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.clearance import Sweep, allow_contact
from hybrid_tamp.symbolic.schedule import Constraint, InfeasibleScheduleError, find_earliest


def find_meeting(
    task: Task, plan: TaskPlan, movements: Sequence[Sweep], note: Callable[[str], None]
) -> tuple[Sweep, Sweep, tuple[str, str]] | None:
    """Return the first two movements that may overlap and meet, with the names of the two bodies, or None.

    Args:
        task: task of the plan.
        plan: the plan.
        movements: movements of the plan in the order of their starts.
        note: called with the name of an instance before its movement is compared.
    """
    precedence = Precedence(task, plan)
    for one, other in combinations(movements, 2):
        if precedence.may_overlap(one.instance, other.instance):
            note(other.instance.name)
            # Movements that start at the same instant keep their timing, and all others may have any timing.
            compare = meet_together if precedence.start_together(one.instance, other.instance) else meet
            for mine, theirs in compared_tracks(task, one, other):
                allowed = allow_contact(mine.body, mine.at(0.0), theirs.body, theirs.at(0.0))
                if compare(mine, theirs, allowed):
                    return one, other, (mine.body.name, theirs.body.name)
    return None


def compared_tracks(task: Task, one: Sweep, other: Sweep) -> Iterator[tuple[Track, Track]]:
    """Yield the pairs of tracks of two movements at the same time, except those of bodies that may touch."""
    rules = ContactRules(
        task.domain.block_by_name, [one.instance, other.instance], task.fixed_bodies, task.token_by_name
    )
    tokens = task.token_by_name
    for mine in one.tracks:
        for theirs in other.tracks:
            names = mine.body.name, theirs.body.name
            if not (rules.allow(*names, one.trace.world) or pass_through(tokens[names[0]], tokens[names[1]])):
                yield mine, theirs


def put_in_order(task: Task, plan: TaskPlan, first: str, second: str) -> TaskPlan | None:
    """Return the plan in which one instance starts after another one has reached its exit, or None if it cannot.

    The durations of all instances remain. The times are the earliest ones.
    """
    ordered = plan.with_order(first, second)
    events = reassignments(task, plan)
    try:
        times = find_earliest(list(_constraints(task, ordered, events)), len(events) + 1)
    except InfeasibleScheduleError:
        return None
    start, end = _instants(plan, events)
    changed = {}
    for each in plan.instances:
        begin = times[start[each.name]]
        reached = None if each.reached is None else round(begin + each.reached - each.start, 6)
        changed[each.name] = (begin, reached, times[end[each.name]])
    return ordered.retime(changed)


def _instants(plan: TaskPlan, events: Sequence[Reassignment]) -> tuple[dict[str, int], dict[str, int]]:
    """Return the indices of the instants at which each instance starts and ends. Index 0 is the start of the plan."""
    start = {instance.name: 0 for instance in initial(plan)}
    end: dict[str, int] = {}
    for index, event in enumerate(events, start=1):
        start |= {instance.name: index for instance in event.starting}
        end |= dict.fromkeys(event.ending, index)
    return start, end


def _constraints(task: Task, plan: TaskPlan, events: Sequence[Reassignment]) -> Iterator[Constraint]:
    """Yield the constraints between the instants of a plan, whose durations are fixed."""
    start, end = _instants(plan, events)
    for index, event in enumerate(events, start=1):
        yield 0, index, 0.0, "no event precedes the beginning of the plan"
        yield from ((before + 1, index, 0.0, "two reassignments keep their order") for before in event.after)
    for each in plan.instances:
        lasts = each.active.end - each.start
        reason = f"{each.name} lasts {lasts:.2f} s"
        yield start[each.name], end[each.name], lasts, reason
        if each.reached is None:
            yield end[each.name], start[each.name], -lasts, reason
        for other in plan.instances:
            earlier = start[each.name] < start[other.name] <= end[each.name]
            if (each.name, other.name) in plan.order or (earlier and must_wait(task, plan, each, other)):
                yield start[each.name], start[other.name], lasts, f"{other.name} waits for {each.name}"
