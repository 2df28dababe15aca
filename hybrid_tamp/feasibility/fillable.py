"""Which blocks tokens can fill: by their classes alone, or by classes, feasibility facts and edges."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence, Set
from functools import cached_property

from hybrid_tamp.feasibility.bindings import MOST, Bound, TooMany, order_conditions
from hybrid_tamp.feasibility.reachable_slots import Passages
from hybrid_tamp.model.bindings import enumerate_bindings, order_roles
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.facts import StaticFacts
from hybrid_tamp.model.predicate import Literal, SymbolSort, Value, name_of
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token


class Members:
    """The members of classes among some tokens."""

    def __init__(self, tokens: Iterable[Token]) -> None:
        # From each token up to the classes above its own: asking every class of every token takes longer.
        self._of: defaultdict[type, list[Token]] = defaultdict(list)
        for token in tokens:
            for above in {above for member in token.classes for above in member.__mro__}:
                self._of[above].append(token)

    def can_fill(self, block: Block) -> bool:
        """Say whether the slots and targets of a block, except symbols, can have a different token each."""
        # The roles with the fewest members first; one with as many members as there are roles always finds one left.
        members = sorted(self._of_roles(block), key=len)
        tight = {str(role): tokens for role, tokens in enumerate(members) if len(tokens) < len(members)}
        return next(enumerate_bindings(tight), None) is not None

    def names(self, block: Block) -> Set[str]:
        """Return the names of the tokens that fit a slot or a target of a block."""
        return frozenset(token.name for tokens in self._of_roles(block) for token in tokens)

    def _of_roles(self, block: Block) -> list[Sequence[Token]]:
        return [self._of.get(sort, []) for sort in block.roles.values() if not isinstance(sort, SymbolSort)]


class FillableBlocks:
    """The blocks that a task's tokens can fill; the tokens can come to them through such blocks only."""

    def __init__(self, task: Task) -> None:
        self._task = task
        self._facts = StaticFacts(task)

    def witness(self, block: Block, fixed: Bound) -> Mapping[str, str] | None:
        """Return a binding of a block as names, or None if there is none.

        Raises:
            TooMany: there are more choices of tokens than are examined.
        """
        found = self._find(block, fixed, self.passages)
        return None if found is None else {role: name_of(value) for role, value in found.items()}

    @cached_property
    def passages(self) -> Passages:
        """The slots to which tokens can come through blocks that can be filled.

        Raises:
            TooMany: there are more choices of tokens than are examined.
        """
        blocks: Collection[str] = [block.name for block in self._task.domain.blocks]
        while True:
            passages = Passages(self._task, blocks)
            fewer = [n for n in blocks if self._find(self._task.domain.block_by_name[n], {}, passages) is not None]
            if len(fewer) == len(blocks):
                return passages
            blocks = fewer

    def _find(self, block: Block, fixed: Bound, passages: Passages) -> Bound | None:
        conditions = order_conditions(block)
        examined = 0

        def holds(literal: Literal, bound: Mapping[str, Value]) -> bool:
            nonlocal examined
            examined += 1
            if examined > MOST:
                raise TooMany
            return self._facts.margin(literal, bound) >= 0

        choices = order_roles(self._task.choices(block, fixed), conditions)
        found = enumerate_bindings(choices, conditions, holds)
        return next((bound for bound in found if passages.allow(block, bound)), None)
