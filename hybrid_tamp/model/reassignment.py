"""A plan as a partial order of events; the planned instants are only estimates.

Two events keep their order if an instance of one and an instance of the other have a token in common (places included,
in any role). Conditions are over an instance's own roles only, so other events can happen in either order, each as soon
as its conditions hold.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from hybrid_tamp.model.plan import BlockInstance, TaskPlan, at
from hybrid_tamp.model.task import Task


@dataclass(frozen=True)
class Reassignment:
    """Instances that end and start at one instant.

    Attributes:
        planned: instant in the plan [s].
        ending: names of the instances that end.
        starting: the instances that start; empty at the end of the plan.
        after: indices of the events that must happen before.
        final: whether it is the end of the plan.
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
    """Return the events of a plan, ordered by planned instant, the end of the plan last.

    Reassignments that are at one instant but have no common token become several events.
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
