"""The plan as an order of events: its instants are estimates, only their order counts.

Two events of a plan keep their order if an instance of the one and an instance of the other have a token in common,
places included, in any role. Conditions speak of an instance's own roles only, so events without a common token can
happen in either order, and each as soon as it can.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from hybrid_tamp.model.plan import BlockInstance, TaskPlan, at
from hybrid_tamp.model.task import Task


@dataclass(frozen=True)
class Reassignment:
    """Instances that end and start at one instant.

    Attributes:
        planned: when the plan expects it [s].
        ending: names of the instances that end.
        starting: the instances that start; none at the plan's end.
        after: indices of the events that come first.
        final: whether it is the plan's end.
    """

    planned: float
    ending: tuple[str, ...]
    starting: tuple[BlockInstance, ...]
    after: frozenset[int]
    final: bool = False


def initial(plan: TaskPlan) -> tuple[BlockInstance, ...]:
    """Return the instances that run from the beginning."""
    return tuple(instance for instance in plan.instances if at(instance.start, 0.0))


def reassignments(task: Task, plan: TaskPlan) -> tuple[Reassignment, ...]:
    """Return the plan's events, ordered by planned instant, the plan's end last.

    What the plan lets happen at one instant by coincidence, without a common token, becomes several events.
    """
    found: list[Reassignment] = []
    touched: list[frozenset[str]] = []
    for time in plan.instants:
        if at(time, 0.0) or at(time, plan.makespan):
            continue
        here = [i for i in plan.instances if at(i.start, time) or at(i.end, time)]
        earlier = tuple(touched)
        for group in _connected(task, here):
            tokens = frozenset().union(*(_tokens(task, instance) for instance in group))
            found.append(
                Reassignment(
                    time,
                    tuple(sorted(i.name for i in group if at(i.end, time))),
                    tuple(i for i in group if at(i.start, time)),
                    frozenset(index for index, others in enumerate(earlier) if others & tokens),
                )
            )
            touched.append(tokens)
    last = tuple(sorted(i.name for i in plan.instances if at(i.end, plan.makespan)))
    found.append(Reassignment(plan.makespan, last, (), frozenset(range(len(found))), final=True))
    return tuple(found)


def _tokens(task: Task, instance: BlockInstance) -> frozenset[str]:
    return frozenset(name for name in instance.roles.values() if name in task.token_by_name)


def _connected(task: Task, instances: Iterable[BlockInstance]) -> list[list[BlockInstance]]:
    """Group the instances that have tokens in common, directly or through others."""
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
