"""Reduction of a task's network to the part that the task's objects and hands afford (paper, Sec. II-C).

"The size of the network can be reduced by only considering the parts of the network associated with the affordances of
the objects that need to be manipulated." The reduced task has fewer tokens, and its domain has fewer blocks. A plan of
the reduced task is extended to a plan of the whole task.
"""

from collections.abc import Collection, Mapping, Set
from dataclasses import dataclass, replace
from functools import cached_property

from hybrid_tamp.feasibility.fillable import Members
from hybrid_tamp.feasibility.relevance import restrict_domain
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.expectation import expect
from hybrid_tamp.model.making_way import makes_way
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import ANY
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token


@dataclass(frozen=True, eq=False)
class Reduction:
    """A reduced task, with the data to extend its plans to the whole task.

    Attributes:
        whole: the task before the reduction.
        brought: names of the tokens that were added as tools.
        tokens: names of the tokens of the reduced task.
        blocks: blocks of the reduced network.
        fillable: blocks whose roles the tokens can fill. The blocks may be unreachable along the edges of the network.
    """

    whole: Task
    brought: tuple[str, ...]
    tokens: Set[str]
    blocks: tuple[Block, ...]
    fillable: tuple[Block, ...]

    @cached_property
    def names(self) -> frozenset[str]:
        """Names of the blocks of the reduced network."""
        return frozenset(block.name for block in self.blocks)

    @cached_property
    def task(self) -> Task:
        """The reduced task, whose domain has the reduced network."""
        kept = [token for token in self.whole.tokens if token.name in self.tokens]
        return self.whole.restrict(self.tokens, domain=restrict_domain(self.whole, self.blocks, kept))

    @cached_property
    def tokens_left_out(self) -> tuple[str, ...]:
        """Sorted names of the tokens outside the reduced task."""
        return tuple(sorted(self.whole.token_by_name.keys() - self.tokens))

    def restore(self, plan: TaskPlan) -> TaskPlan:
        """Extend a plan of the reduced task to the whole task. Tokens that were left out rest for the whole plan."""
        whole, resting = self.whole, self.whole.domain.resting_block
        left_out = [token for name in self.tokens_left_out if not (token := whole.token_by_name[name]).place]
        number = sum(instance.block == resting.name for instance in plan.instances)
        more = [
            _resting(whole, resting, token, f"{resting.name}-{number + index}", plan.makespan)
            for index, token in enumerate(left_out, start=1)
        ]
        instances = sorted((*plan.instances, *more), key=lambda i: (i.start, i.end, i.name))
        return replace(plan, instances=tuple(instances)) if more else plan


def _resting(task: Task, block: Block, token: Token, name: str, end: float) -> BlockInstance:
    binding = {block.anchor: token}
    initial = block.initial_values(binding, task.state)
    expected = expect(block, binding, task.state, initial).seconds
    return BlockInstance(name, block.name, {block.anchor: token.name}, 0.0, end, reached=min(expected, end))


class Reducer:
    """Reduction of one task with different sets of added tools."""

    def __init__(self, task: Task) -> None:
        self._task = task
        self._begun = {name: block for name, block in task.assignment.items() if block != task.domain.resting}

    @cached_property
    def needed(self) -> frozenset[str]:
        """Names of the tokens in the goal or in its groundings, and of the tokens that do not start at rest."""
        chosen = (each for atom in self._task.goal if ANY in atom.arguments for each in self._task.groundings(atom))
        named = (name for atom in (*self._task.goal, *chosen) for name in atom.arguments)
        return frozenset(name for name in (*named, *self._begun) if name in self._task.token_by_name)

    @cached_property
    def capable(self) -> frozenset[str]:
        """Names of the tokens that belong to agents or have basic actions."""
        owned = (name for names in self._task.agents.values() for name in names)
        return frozenset((*owned, *(token.name for token in self._task.tokens if token.basic_actions)))

    def reduce(self, brought: Collection[str] = (), among: Collection[Block] | None = None) -> Reduction:
        """Reduce the task to the blocks that the present tokens can fill together.

        The present tokens are needed tokens, capable tokens, places and the added tools. A block is kept if:

        - the block does more than move a single token along a path (`makes_way`),
        - the present tokens can fill its slots and targets,
        - edges lead into all of its slots,
        - edges lead out of all of its slots, or the block has ``hold``, and
        - a chain of shared tokens connects the block to the needed tokens.

        A token is kept if the token is needed or fits a kept block.

        Args:
            brought: names of the tokens to add as tools.
            among: blocks that may be kept. By default, all blocks of the domain.
        """
        domain = self._task.domain
        present = self.needed | self.capable | self._places
        tokens = [token for token in self._task.tokens if token.name in present]
        members = Members([*tokens, *(self._task.token_by_name[name] for name in brought)])
        blocks = domain.blocks if among is None else among
        fillable = [block for block in blocks if not makes_way(block) and members.can_fill(block)]
        passable = _keep_passable(domain, fillable, {domain.resting, *self._begun.values()})
        able = {block.name: members.names(block) for block in passable if block.name != domain.resting}
        related = self._relate(able)
        kept = [block for block in passable if block.name in related or block.name not in able]
        names = self.needed.union(*(able[name] for name in related))
        return Reduction(self._task, tuple(brought), names, tuple(kept), tuple(fillable))

    def _relate(self, able: Mapping[str, Set[str]]) -> list[str]:
        """Return the names of the blocks that chains of shared tokens (not places) connect to the needed tokens."""
        tokens, related = set(self.needed - self._places), list[str]()
        waiting = dict(able)
        while found := [name for name, fit in waiting.items() if not tokens.isdisjoint(fit)]:
            related += found
            tokens.update(*(waiting.pop(name) - self._places for name in found))
        return related

    @cached_property
    def _places(self) -> frozenset[str]:
        return frozenset(token.name for token in self._task.tokens if token.place)


def _keep_passable(domain: Domain, blocks: list[Block], started: Collection[str]) -> list[Block]:
    """Return the blocks that tokens can reach from initial blocks and, without ``hold``, can leave."""
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
    """Return the names of the initial blocks and of blocks with an edge from an enterable block into every slot."""
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
