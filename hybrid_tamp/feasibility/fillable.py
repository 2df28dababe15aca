"""Checks of whether tokens can fill the roles of a block.

`Members` compares only classes. `FillableBlocks` also checks feasibility facts, network edges and preconditions.
"""

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence, Set
from functools import cached_property

from hybrid_tamp.feasibility.backward_search import BackwardSearch
from hybrid_tamp.feasibility.bindings import MOST, Bound, TooMany, order_conditions
from hybrid_tamp.feasibility.reachable_slots import Passages
from hybrid_tamp.model.bindings import enumerate_bindings, order_roles
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.facts import StaticFacts
from hybrid_tamp.model.predicate import ANY, Atom, Literal, SymbolSort, Value, name_of
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token


class Members:
    """Lookup of the members of each class among the given tokens."""

    def __init__(self, tokens: Iterable[Token]) -> None:
        # Collecting the base classes of each token is faster than testing each token against each class.
        self._of: defaultdict[type, list[Token]] = defaultdict(list)
        for token in tokens:
            for above in {above for member in token.classes for above in member.__mro__}:
                self._of[above].append(token)

    def can_fill(self, block: Block) -> bool:
        """Say whether different tokens can fill all slots and targets of a block. Targets with symbols are ignored."""
        # A role with at least as many candidates as the block has roles always has a free candidate.
        members = sorted(self._of_roles(block), key=len)
        tight = {str(role): tokens for role, tokens in enumerate(members) if len(tokens) < len(members)}
        return next(enumerate_bindings(tight), None) is not None

    def names(self, block: Block) -> Set[str]:
        """Return the names of the tokens that can fill a slot or a target of a block."""
        return frozenset(token.name for tokens in self._of_roles(block) for token in tokens)

    def _of_roles(self, block: Block) -> list[Sequence[Token]]:
        return [self._of.get(sort, []) for sort in block.roles.values() if not isinstance(sort, SymbolSort)]


class FillableBlocks:
    """The blocks that a task's tokens can fill. A token passes only through fillable blocks to reach a block.

    A block is fillable only if every atom that it needs holds initially or may be achieved (see `backward_search`).
    """

    def __init__(self, task: Task) -> None:
        self._task = task
        self._facts = StaticFacts(task)
        self._search = BackwardSearch(task)
        self._achievable: dict[Atom, bool] = {}

    def witness(self, block: Block, fixed: Bound) -> Mapping[str, str] | None:
        """Return a feasible binding of a block that includes `fixed`, or None. The binding maps roles to names.

        Raises:
            TooMany: the number of bindings to examine exceeds `MOST`.
        """
        found = self._find(block, fixed, self.passages)
        return None if found is None else {role: name_of(value) for role, value in found.items()}

    @cached_property
    def passages(self) -> Passages:
        """Slots that each token can reach through blocks that tokens can fill.

        Raises:
            TooMany: the number of bindings to examine exceeds `MOST`.
        """
        blocks: Collection[str] = [block.name for block in self._task.domain.blocks]
        while True:
            passages = Passages(self._task, blocks)
            fewer = [n for n in blocks if self._find(self._task.domain.block_by_name[n], {}, passages) is not None]
            if len(fewer) == len(blocks):
                return passages
            blocks = fewer

    def _find(self, block: Block, fixed: Bound, passages: Passages) -> Bound | None:
        needed = tuple(each for each in block.changing_entry if each.positive and ANY not in each.arguments)
        conditions = (*order_conditions(block), *needed)
        examined = 0

        def holds(literal: Literal, bound: Mapping[str, Value]) -> bool:
            nonlocal examined
            examined += 1
            if examined > MOST:
                raise TooMany
            return (
                self._facts.margin(literal, bound) >= 0 if literal.predicate.static else self._may_hold(literal, bound)
            )

        choices = order_roles(self._task.choices(block, fixed), conditions)
        found = enumerate_bindings(choices, conditions, holds)
        return next((bound for bound in found if passages.allow(block, bound)), None)

    def _may_hold(self, literal: Literal, bound: Mapping[str, Value]) -> bool:
        """Return False if no plan can achieve a precondition. True does not mean that a plan achieves the condition."""
        atom = literal.ground(bound)
        if atom not in self._achievable:
            try:
                self._achievable[atom] = self._search.holds(atom) or self._search.explore(atom)
            except TooMany:
                self._achievable[atom] = True
        return self._achievable[atom]
