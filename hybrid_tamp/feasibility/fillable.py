"""Which blocks the tokens of a task can fill, as far as classes, feasibility facts and edges decide."""

from collections.abc import Collection, Mapping
from functools import cached_property

from hybrid_tamp.feasibility.bindings import MOST, Bound, Margins, TooMany, static_entry
from hybrid_tamp.feasibility.passages import Passages
from hybrid_tamp.model.bindings import enumerate_bindings, order_roles
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Literal, Value, name_of
from hybrid_tamp.model.task import Task


class FillableBlocks:
    """The blocks that a task's tokens can fill, and to which tokens can come through such blocks only."""

    def __init__(self, task: Task, margins: Margins | None = None) -> None:
        self._task = task
        self._margins = margins or Margins(task)

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
        conditions = static_entry(block)
        examined = 0

        def holds(literal: Literal, bound: Mapping[str, Value]) -> bool:
            nonlocal examined
            examined += 1
            if examined > MOST:
                raise TooMany
            return self._margins.of(literal, bound) >= 0

        choices = order_roles(self._task.choices(block, fixed), conditions)
        found = enumerate_bindings(choices, conditions, holds)
        return next((bound for bound in found if passages.allow(block, bound)), None)
