"""Which of some tokens could fill the slots and targets of a block, all of them at once."""

from collections import defaultdict
from collections.abc import Iterable, Sequence, Set

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import SymbolSort
from hybrid_tamp.model.token import Token


class Members:
    """The members of classes among some tokens."""

    def __init__(self, tokens: Iterable[Token]) -> None:
        # From each token up to the classes above its own: asking every class of every token takes longer.
        self._of: defaultdict[type, set[str]] = defaultdict(set)
        for token in tokens:
            for above in {above for member in token.classes for above in member.__mro__}:
                self._of[above].add(token.name)

    def of(self, object_class: type[ObjectClass]) -> Set[str]:
        """Return the names of the members of a class."""
        return self._of.get(object_class, frozenset())

    def can_fill(self, block: Block) -> bool:
        """Say whether there is a token for each slot and each target that is no symbol, a different one for each."""
        return _choosable(self._fitting(block))

    def able(self, block: Block) -> Set[str]:
        """Return the names of the tokens that fit a slot or a target of the block."""
        return frozenset().union(*self._fitting(block))

    def _fitting(self, block: Block) -> list[Set[str]]:
        return [self.of(sort) for sort in block.roles.values() if not isinstance(sort, SymbolSort)]


def _choosable(sets: Sequence[Set[str]]) -> bool:
    """Say whether one element of each set can be chosen so that all are different."""
    # A set with enough elements for all has one left for itself, whatever the others take.
    tight = sorted((each for each in sets if len(each) < len(sets)), key=len)
    if not tight:
        return True
    return any(_choosable([each - {chosen} for each in tight[1:]]) for chosen in sorted(tight[0]))
