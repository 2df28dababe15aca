"""Affordances of objects in the perspectives of the environment, an agent, an observer and a team (paper, Sec. II-E).

An object affords a block if the object can fill one of the block's slots. The *environment's* perspective considers
only the classes of the object. In an *agent's* perspective, tokens must fill the other slots, and these tokens must not
belong to other agents. The feasibility facts of this binding must hold, and the network must have a path for every
token to its slot. Each precondition must hold initially, or be achievable if the deleted atoms of all blocks are
ignored. The binding is called the witness of the affordance. The *observer* compares all agents, and a *team* pools the
tokens of several agents.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import combinations

from hybrid_tamp.feasibility.fillable import FillableBlocks
from hybrid_tamp.model.affordance import CapabilityClass
from hybrid_tamp.model.affordances import Affordance, Implication, View
from hybrid_tamp.model.block import Block, Slot
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.questions.changes import task_root, without_token


def find_affordances(task: Task, view: View, agent: str | None = None) -> list[Affordance]:
    """Return the affordances of all objects from one perspective.

    If an agent is given, affordances that involve only other agents are left out.
    """
    views: Mapping[View, Callable[[Task], list[Affordance]]] = {
        "environment": environment,
        "agent": lambda of: [each for name in of.agents for each in afforded_to(of, name)],
        "observer": lambda of: observer(of)[0],
        "team": team,
    }
    return [each for each in views[view](task) if agent is None or not each.agents or agent in each.agents]


def environment(task: Task) -> list[Affordance]:
    """Return the affordances that follow from the classes of the objects alone."""
    return [
        Affordance((), thing.name, block.name, slot.name, {})
        for thing in task.assigned
        for block, slot in _offered(task, thing)
    ]


def afforded_to(task: Task, *names: str) -> list[Affordance]:
    """Return the affordances for an agent, or for several agents that pool their tokens."""
    own = _of_agents(task, names)
    fillable = FillableBlocks(own)
    found = []
    for thing in own.assigned:
        for block, slot in _offered(own, thing):
            witness = fillable.witness(block, {slot.name: thing})
            if witness is not None:
                found.append(Affordance(names, thing.name, block.name, slot.name, witness))
    return found


def observer(task: Task) -> tuple[list[Affordance], list[Implication]]:
    """Return the affordances for each agent, and implications for other agents with at least the same capabilities."""
    by_agent = {name: afforded_to(task, name) for name in task.agents}
    implied = [
        Implication(seen, other, next((one.witness for one in by_agent[other] if one.key[1:] == seen.key[1:]), {}))
        for name, affordances in by_agent.items()
        for other in task.agents
        if other != name and capabilities(task, other) >= capabilities(task, name)
        for seen in affordances
    ]
    return [one for affordances in by_agent.values() for one in affordances], implied


def team(task: Task) -> list[Affordance]:
    """Return each affordance that a group of agents has and that no smaller part of this group has."""
    found: list[Affordance] = []
    known: dict[tuple[object, ...], list[frozenset[str]]] = {}
    for size in range(1, len(task.agents) + 1):
        for names in combinations(task.agents, size):
            group = frozenset(names)
            new = [a for a in afforded_to(task, *names) if not any(g < group for g in known.get(a.key[1:], ()))]
            for affordance in new:
                known.setdefault(affordance.key[1:], []).append(group)
            found += new if size > 1 else []
    return found


def capabilities(task: Task, name: str) -> frozenset[tuple[str, int]]:
    """Return a set that contains (capability class, n) if the agent has at least n tokens of the class."""
    counted: list[str] = []
    for token in task.agents[name]:
        counted += [each.name for each in task.token_by_name[token].classes if issubclass(each, CapabilityClass)]
    return frozenset((each, number + 1) for each in counted for number in range(counted.count(each)))


def _of_agents(task: Task, names: Iterable[str]) -> Task:
    """Return the task without the tokens of all other agents."""
    own = {token for name in names for token in task.agents[name]}
    others = {token for tokens in task.agents.values() for token in tokens} - own
    for token in task.tokens:
        if token.name in others:
            task = without_token(task, token)
    return task


def _offered(task: Task, thing: Token) -> Iterator[tuple[Block, Slot]]:
    """Yield (block, slot) for each slot with a class of the object. Hand slots and general slots are left out."""
    for block in task.domain.blocks:
        for slot in block.slots:
            general = slot.object_class is task_root(task) or issubclass(slot.object_class, CapabilityClass)
            if not general and thing.is_member(slot.object_class):
                yield block, slot
