"""Reduction: the part of a task's network that its objects and hands afford (paper, Sec. II-C).

"The size of the network can be reduced by only considering the parts of the network associated with the affordances of
the objects that need to be manipulated." Before: a task of a domain that may have many blocks, and many tokens. After:
a smaller task of a smaller domain, and from a plan of it a plan of the whole.
"""

from collections.abc import Collection, Mapping, Set
from dataclasses import dataclass, replace
from functools import cached_property

from hybrid_tamp.feasibility.domain_part import domain_part
from hybrid_tamp.feasibility.members import Members
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import ANY
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token


@dataclass(frozen=True, eq=False)
class Reduction:
    """A task reduced.

    Attributes:
        whole: the task.
        tokens: names of the tokens that are left of it.
        blocks: the blocks of the reduced network.
        fillable: these, and blocks that tokens could fill if they could come to them.
    """

    whole: Task
    tokens: Set[str]
    blocks: tuple[Block, ...]
    fillable: tuple[Block, ...]

    @cached_property
    def names(self) -> frozenset[str]:
        """Names of the blocks of the reduced network."""
        return frozenset(block.name for block in self.blocks)

    @cached_property
    def task(self) -> Task:
        """What is left of the task, of a domain with what is left of the network."""
        kept = [token for token in self.whole.tokens if token.name in self.tokens]
        return self.whole.restrict(self.tokens, domain=domain_part(self.whole, self.blocks, kept))

    @cached_property
    def blocks_left_out(self) -> tuple[str, ...]:
        """Names of the blocks that are not in the reduced network, sorted."""
        return tuple(sorted(self.whole.domain.block_by_name.keys() - self.names))

    @cached_property
    def tokens_left_out(self) -> tuple[str, ...]:
        """Names of the tokens that are not in the reduced task, sorted; all but places rest all the time."""
        return tuple(sorted(self.whole.token_by_name.keys() - self.tokens))

    def restore(self, plan: TaskPlan) -> TaskPlan:
        """Return the plan of the whole task from one of the reduced task: what was left out rests from start to end."""
        whole = self.whole
        resting = whole.domain.resting_block
        left_out = [whole.token_by_name[name] for name in self.tokens_left_out]
        number = sum(instance.block == resting.name for instance in plan.instances)
        more = [
            _resting(whole, resting, token, f"{resting.name}-{number + index}", plan.makespan)
            for index, token in enumerate((token for token in left_out if not token.place), start=1)
        ]
        instances = sorted((*plan.instances, *more), key=lambda i: (i.start, i.end, i.name))
        return replace(plan, instances=tuple(instances)) if more else plan


def _resting(task: Task, block: Block, token: Token, name: str, end: float) -> BlockInstance:
    binding = {block.anchor: token}
    expected = float(block.duration.expected(binding, task.state, block.initial_values(binding, task.state)))
    return BlockInstance(name, block.name, {block.anchor: token.name}, 0.0, end, reached=min(expected, end))


class Reducer:
    """Reduces one task, with more and more tokens."""

    def __init__(self, task: Task) -> None:
        self._task = task
        self._begun = {name: block for name, block in task.assignment.items() if block != task.domain.resting}

    @cached_property
    def needed(self) -> frozenset[str]:
        """The tokens that the goal names, or leaves to choose from, and those that start in a block."""
        chosen = (each for atom in self._task.goal if ANY in atom.arguments for each in self._task.groundings(atom))
        named = (name for atom in (*self._task.goal, *chosen) for name in atom.arguments)
        return frozenset(name for name in (*named, *self._begun) if name in self._task.token_by_name)

    @cached_property
    def capable(self) -> frozenset[str]:
        """The tokens that agents have, or that have basic actions."""
        owned = (name for names in self._task.agents.values() for name in names)
        return frozenset((*owned, *(token.name for token in self._task.tokens if token.basic_actions)))

    @cached_property
    def _there(self) -> tuple[Token, ...]:
        """The tokens that are there without being brought in."""
        names = self.needed | self.capable
        return tuple(token for token in self._task.tokens if token.name in names | self._places)

    def reduce(self, brought: Collection[str] = (), among: Collection[Block] | None = None) -> Reduction:
        """Reduce the task to what its goal's tokens, the agents' and those that are in a block already can do together.

        Blocks that are left out have a slot or a target that none of these can fill, no way in, or no way out where
        one must leave, or nothing to do with the goal's tokens, not even by way of others. Places are always there.
        Tokens that fit nowhere in what is left are left out, too.

        Args:
            brought: names of further tokens, brought in as tools.
            among: the blocks that may be left; by default all.
        """
        domain = self._task.domain
        members = Members([*self._there, *(self._task.token_by_name[name] for name in brought)])
        fillable = [block for block in (domain.blocks if among is None else among) if members.can_fill(block)]
        blocks = _keep_passable(domain, fillable, {domain.resting, *self._begun.values()})
        able = {block.name: members.able(block) for block in blocks if block.name != domain.resting}
        related = self._relate(able)
        kept = [block for block in blocks if block.name in related or block.name not in able]
        return Reduction(self._task, self.needed.union(*(able[name] for name in related)), tuple(kept), tuple(fillable))

    def _relate(self, able: Mapping[str, Set[str]]) -> list[str]:
        """Return the blocks that have to do with the needed tokens, if only by way of others; places lead nowhere."""
        tokens, related = set(self.needed - self._places), list[str]()
        waiting = dict(able)
        while found := [name for name, fit in waiting.items() if not tokens.isdisjoint(fit)]:
            related += found
            tokens.update(*(waiting.pop(name) - self._places for name in found))
        return related

    @cached_property
    def _places(self) -> frozenset[str]:
        return frozenset(token.name for token in self._task.tokens if token.place)


def reduce_task(task: Task, brought: Collection[str] = ()) -> Reduction:
    """Reduce a task, with tokens brought in as tools (see `Reducer.reduce`)."""
    return Reducer(task).reduce(brought)


def _keep_passable(domain: Domain, blocks: list[Block], started: Collection[str]) -> list[Block]:
    """Keep the blocks that tokens can come to from where they start, and leave if they must."""
    kept = {block.name: block for block in blocks} | {name: domain.block_by_name[name] for name in started}
    size = -1
    while len(kept) != size:
        size = len(kept)
        entered = _enterable_blocks(domain, kept, started)
        kept = {
            name: block
            for name, block in kept.items()
            if name in started or (name in entered and (block.hold or _can_be_left(domain, block, kept)))
        }
    return list(kept.values())


def _enterable_blocks(domain: Domain, blocks: Mapping[str, Block], started: Collection[str]) -> set[str]:
    """Return the blocks whose slots can all be come into, along edges from the blocks in which tokens start."""
    entered, size = set(started), -1
    while len(entered) != size:
        size = len(entered)
        entered |= {
            name
            for name, block in blocks.items()
            if name not in entered
            and all(any(b in entered for b, _ in domain.network.sources((name, s.name))) for s in block.slots)
        }
    return entered


def _can_be_left(domain: Domain, block: Block, blocks: Collection[str]) -> bool:
    return all(any(b in blocks for b, _ in domain.network.destinations((block.name, s.name))) for s in block.slots)
