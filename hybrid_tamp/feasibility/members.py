"""Which of some tokens could fill the slots and targets of a block, all of them at once, by their classes alone."""

from collections import defaultdict
from collections.abc import Iterable, Sequence, Set

from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import SymbolSort
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
        """Say whether there is a token for each slot and each target that is no symbol, a different one for each."""
        # The roles with the fewest members first; one with as many members as there are roles always finds one left.
        members = sorted(self._of_roles(block), key=len)
        tight = {str(role): tokens for role, tokens in enumerate(members) if len(tokens) < len(members)}
        return next(enumerate_bindings(tight), None) is not None

    def able(self, block: Block) -> Set[str]:
        """Return the names of the tokens that fit a slot or a target of the block."""
        return frozenset(token.name for tokens in self._of_roles(block) for token in tokens)

    def _of_roles(self, block: Block) -> list[Sequence[Token]]:
        sorts = (sort for sort in block.roles.values() if not isinstance(sort, SymbolSort))
        return [self._of.get(sort, []) for sort in sorts]
