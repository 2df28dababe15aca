"""The partial order of the reassignments of a plan. A run keeps this order, but not the instants, which are estimates.

Two reassignments keep their order if they involve the same token, in any role. The token can be a place. They also keep
their order if the plan orders the instances that start in them (`TaskPlan.order`). All other pairs of reassignments can
happen in either order, because the conditions of an instance depend only on its tokens. Each reassignment happens as
soon as its conditions hold.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from hybrid_tamp.model.plan import BlockInstance, TaskPlan, at
from hybrid_tamp.model.task import Task


@dataclass(frozen=True)
class Reassignment:
    """Instances that end and instances that start at the same instant.

    Attributes:
        planned: planned instant of the reassignment [s].
        ending: names of the instances that end.
        starting: instances that start. Empty at the end of the plan.
        after: indices of the reassignments that must happen before this reassignment.
        final: whether the reassignment is the end of the plan.
    """

    planned: float
    ending: tuple[str, ...]
    starting: tuple[BlockInstance, ...]
    after: frozenset[int]
    final: bool = False


def initial(plan: TaskPlan) -> tuple[BlockInstance, ...]:
    """Return the instances that start at the beginning of the plan."""
    return tuple(instance for instance in plan.instances if at(instance.start, 0.0))


def reassignments(task: Task, plan: TaskPlan) -> tuple[Reassignment, ...]:
    """Return the reassignments of a plan, sorted by planned instant. The last reassignment is the end of the plan.

    Instances that start or end at the same instant are in different reassignments if no tokens connect them.
    """
    found: list[Reassignment] = []
    touched: list[frozenset[str]] = []
    for time in plan.instants:
        if at(time, 0.0) or at(time, plan.makespan):
            continue
        here = [i for i in plan.instances if at(i.start, time) or at(i.end, time)]
        earlier = tuple(touched)
        begun = {each.name: index for index, event in enumerate(found) for each in event.starting}
        for group in _connected(task, here):
            tokens = frozenset().union(*(_tokens(task, instance) for instance in group))
            found.append(
                Reassignment(
                    time,
                    tuple(sorted(i.name for i in group if at(i.end, time))),
                    tuple(i for i in group if at(i.start, time)),
                    frozenset(index for index, others in enumerate(earlier) if others & tokens)
                    | {begun[one] for one, other in plan.order if one in begun and _starts(group, other, time)},
                )
            )
            touched.append(tokens)
    last = tuple(sorted(i.name for i in plan.instances if at(i.end, plan.makespan)))
    found.append(Reassignment(plan.makespan, last, (), frozenset(range(len(found))), final=True))
    return tuple(found)


def _starts(group: Iterable[BlockInstance], name: str, time: float) -> bool:
    return any(instance.name == name and at(instance.start, time) for instance in group)


def _tokens(task: Task, instance: BlockInstance) -> frozenset[str]:
    return frozenset(name for name in instance.roles.values() if name in task.token_by_name)


def _connected(task: Task, instances: Iterable[BlockInstance]) -> list[list[BlockInstance]]:
    """Return groups of instances that have tokens in common, directly or through other instances of the group."""
    groups: list[tuple[set[str], list[BlockInstance]]] = []
    for instance in instances:
        tokens, members = set(_tokens(task, instance)), [instance]
        apart = []
        for other_tokens, others in groups:
            if other_tokens & tokens:
                tokens |= other_tokens
                members = others + members
            else:
                apart.append((other_tokens, others))
        groups = [*apart, (tokens, members)]
    return [members for _, members in sorted(groups, key=lambda group: group[1][0].name)]
