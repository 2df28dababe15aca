"""Which object affords which block, and to whom (paper, Sec. II-E).

An object affords a block where it can be in one of the block's slots. In the *environment's* perspective its classes
alone say so. In an *agent's* the agent's capability tokens must fill the other slots so that every feasibility fact
holds, and edges must lead all of them there; that choice of tokens is the witness. What depends on the state is not
asked.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations

from hybrid_tamp.feasibility.fillable import Usable
from hybrid_tamp.model.affordance import CapabilityClass
from hybrid_tamp.model.block import Block, Slot
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.questions.changes import task_root, without_token


@dataclass(frozen=True)
class Affordance:
    """An object affords a block.

    Attributes:
        agents: to whom; empty where nobody is asked.
        thing: the object.
        block: the block.
        slot: the slot that it can be in.
        witness: role to token or symbol, of one choice under which it can; empty where classes alone are asked.
    """

    agents: tuple[str, ...]
    thing: str
    block: str
    slot: str
    witness: Mapping[str, str]

    @property
    def key(self) -> tuple[object, ...]:
        """What it says, whatever the witness is."""
        return (self.agents, self.thing, self.block, self.slot)


@dataclass(frozen=True)
class Implication:
    """What an agent that was seen acting implies for another one with the same capability classes.

    Attributes:
        seen: what the agent that was seen is afforded.
        observer: the agent with the same capability classes.
        witness: how the observer can do the same; empty if it cannot for want of a feasibility fact.
    """

    seen: Affordance
    observer: str
    witness: Mapping[str, str]


def environment(task: Task) -> list[Affordance]:
    """Return which object affords which block by its classes alone."""
    return [
        Affordance((), thing.name, block.name, slot.name, {})
        for thing in task.assigned
        for block, slot in _offered(task, thing)
    ]


def agent(task: Task, *names: str) -> list[Affordance]:
    """Return what an agent, or several that pool their tokens, are afforded."""
    own = _of_agents(task, names)
    usable = Usable(own)
    found = []
    for thing in own.assigned:
        for block, slot in _offered(own, thing):
            witness = usable.witness(block, {slot.name: thing})
            if witness is not None:
                found.append(Affordance(names, thing.name, block.name, slot.name, witness))
    return found


def observer(task: Task) -> tuple[list[Affordance], list[Implication]]:
    """Return the pairs of agent and object with what they afford, and what each implies for like agents."""
    by_agent = {name: agent(task, name) for name in task.agents}
    implied = [
        Implication(seen, other, next((one.witness for one in by_agent[other] if one.key[1:] == seen.key[1:]), {}))
        for name, affordances in by_agent.items()
        for other in task.agents
        if other != name and capabilities(task, other) >= capabilities(task, name)
        for seen in affordances
    ]
    return [one for affordances in by_agent.values() for one in affordances], implied


def team(task: Task) -> list[Affordance]:
    """Return what a group of agents is afforded and no smaller group within it is."""
    found: list[Affordance] = []
    known: dict[tuple[object, ...], list[frozenset[str]]] = {}
    for size in range(1, len(task.agents) + 1):
        for names in combinations(task.agents, size):
            group = frozenset(names)
            new = [a for a in agent(task, *names) if not any(part < group for part in known.get(a.key[1:], ()))]
            for affordance in new:
                known.setdefault(affordance.key[1:], []).append(group)
            found += new if size > 1 else []
    return found


def capabilities(task: Task, name: str) -> frozenset[tuple[str, int]]:
    """Return the capability classes of an agent's tokens, each counted from 1, so that more of them include fewer."""
    counted: list[str] = []
    for token in task.agents[name]:
        members = task.token_by_name[token].classes
        counted += [member.name for member in members if issubclass(member, CapabilityClass)]
    return frozenset((each, number + 1) for each in counted for number in range(counted.count(each)))


def _of_agents(task: Task, names: Iterable[str]) -> Task:
    """Return the task without the tokens of other agents."""
    own = {token for name in names for token in task.agents[name]}
    others = {token for tokens in task.agents.values() for token in tokens} - own
    for token in task.tokens:
        if token.name in others:
            task = without_token(task, token)
    return task


def _offered(task: Task, thing: Token) -> Iterator[tuple[Block, Slot]]:
    """Yield the slots that are meant for objects, and not for hands, of whose classes a token is a member."""
    for block in task.domain.blocks:
        for slot in block.slots:
            general = slot.object_class is task_root(task) or issubclass(slot.object_class, CapabilityClass)
            if not general and thing.is_member(slot.object_class):
                yield block, slot
