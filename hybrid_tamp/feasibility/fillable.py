"""Which blocks the tokens of a task can fill, as far as classes, feasibility facts and edges tell."""

from collections.abc import Collection, Iterator, Mapping
from functools import cached_property

from hybrid_tamp.feasibility.bindings import (
    MOST,
    Bound,
    Choices,
    Margins,
    TooMany,
    choices,
    completed,
    extensions,
    static_entry,
)
from hybrid_tamp.feasibility.passages import Passages
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Literal, name_of
from hybrid_tamp.model.task import Task


class Usable:
    """The blocks that a task's tokens can fill, and to which tokens can come through such blocks only."""

    def __init__(self, task: Task, margins: Margins | None = None) -> None:
        self._task = task
        self._margins = margins or Margins(task)

    def witness(self, block: Block, fixed: Bound) -> Mapping[str, str] | None:
        """Return who could be where in a block, or None.

        Raises:
            TooMany: there are more choices of tokens than are looked at.
        """
        found = self._found(block, fixed, self.passages)
        return None if found is None else {role: name_of(value) for role, value in found.items()}

    @cached_property
    def passages(self) -> Passages:
        """The slots to which tokens can come through blocks that can be filled.

        Raises:
            TooMany: there are more choices of tokens than are looked at.
        """
        blocks: Collection[str] = [block.name for block in self._task.domain.blocks]
        while True:
            passages = Passages(self._task, blocks)
            fewer = [n for n in blocks if self._found(self._task.domain.block_by_name[n], {}, passages) is not None]
            if len(fewer) == len(blocks):
                return passages
            blocks = fewer

    def _found(self, block: Block, fixed: Bound, passages: Passages) -> Bound | None:
        allowed = choices(self._task, block, fixed)
        self._tried = 0
        whole = (
            bound
            for partial in self._bound({}, static_entry(block), allowed)
            for bound in completed([partial], allowed)
            if passages.allow(block, bound)
        )
        return next(whole, None)

    def _bound(self, bound: Bound, literals: tuple[Literal, ...], allowed: Choices) -> Iterator[Bound]:
        """Yield the bindings under which all feasibility conditions hold, one after the other."""
        if not literals:
            yield bound
            return
        for more in extensions(literals[0], bound, allowed):
            self._tried += 1
            if self._tried > MOST:
                raise TooMany
            if self._margins.of(literals[0], more) >= 0:
                yield from self._bound(more, literals[1:], allowed)
