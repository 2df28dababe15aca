"""Explanation of each token in a plan by causal links, which are followed from the goal back to the initial state.

A causal link says that an instance (the producer) achieves an atom that a later instance or the goal (the consumer)
needs.
"""

from collections.abc import Iterable, Iterator
from math import inf

from hybrid_tamp.model.explanation import Cause, Link
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Atom, Literal
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token


def find_links(task: Task, plan: TaskPlan) -> list[Link]:
    """Return the causal links from the goal back to the initial state, without duplicates."""
    found: dict[Link, None] = {}
    blocks = task.domain.block_by_name
    open_atoms: list[tuple[Atom, str | None, float]] = [(atom, None, inf) for atom in task.goal]
    seen = set()
    while open_atoms:
        atom, needed_by, before = open_atoms.pop(0)
        # The producer is the last instance that starts before the consumer and achieves the atom.
        makers = [i for i in plan.instances if i.start < before and atom in _ground(task, i, blocks[i.block].exit)]
        producer = max(makers, key=lambda instance: instance.start, default=None)
        if producer is None:
            continue
        found[Link(producer.name, atom, needed_by)] = None
        if producer.name not in seen:
            seen.add(producer.name)
            needed = _ground(task, producer, blocks[producer.block].changing_entry)
            open_atoms += [(each, producer.name, producer.start) for each in needed]
    return list(found)


def find_causes(task: Task, plan: TaskPlan) -> list[Cause]:
    """Return for each token the reason why the plan needs or does not need this token."""
    links = find_links(task, plan)
    instances = {instance.name: instance for instance in plan.instances}
    needed = {link.instance for link in links}
    found = []
    for token in task.tokens:
        own = tuple(link for link in links if token.name in instances[link.instance].roles.values())
        if own:
            why = _why(token, own[0], instances)
        elif any(token.name in atom.arguments for atom in task.goal):
            why = "the goal names this token, but every goal atom that names the token holds in the initial state"
        else:
            why = _why_not(task, plan, token, needed)
        found.append(Cause(token.name, bool(own), why, own))
    return found


def _ground(task: Task, instance: BlockInstance, literals: Iterable[Literal]) -> Iterator[Atom]:
    bound = task.bind(instance.roles)
    return (each.ground(bound) for each in literals if each.positive)


def _why(token: Token, link: Link, instances: dict[str, BlockInstance]) -> str:
    instance = instances[link.instance]
    roles = " and ".join(role for role, name in instance.roles.items() if name == token.name)
    part = "target" if token.place or token.name in instance.targets.values() else "slot"
    return f"{part} {roles} of {instance.name}, which achieves {link.atom.text} for {link.needed_by_text}"


def _why_not(task: Task, plan: TaskPlan, token: Token, needed: set[str]) -> str:
    """Return the reason why this token takes part in no instance that the goal needs."""
    roles = [
        (instance, role)
        for instance in plan.instances
        if instance.name in needed
        for role, sort in task.domain.block_by_name[instance.block].roles.items()
        if isinstance(sort, type) and token.is_member(sort)
    ]
    if not roles:
        return "no block that contributes to the goal has a slot or a target that this token can fill"
    instance, role = roles[0]
    return f"not needed: {instance.roles[role]} already fills {role} of {instance.name}"
