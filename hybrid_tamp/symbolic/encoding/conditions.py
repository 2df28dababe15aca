"""Assignment of the conditions of blocks to operators.

A condition belongs to the operator in which all its roles are known. A condition on the anchor and targets belongs to
`begin`. A condition on other slots belongs to the `fill` of the last of them. If the conditions of several fills
mention a target, the first fill binds it, and `begin` must agree.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from hybrid_tamp.model.block import Block, Target
from hybrid_tamp.model.predicate import Literal, SymbolSort
from hybrid_tamp.symbolic.encoding.assignment import keeper, locked_targets
from hybrid_tamp.symbolic.encoding.vocabulary import Vocabulary


@dataclass(frozen=True, eq=False)
class Conditions:
    """Assigns the conditions of the blocks of one domain to operators."""

    vocabulary: Vocabulary

    def entry_at_begin(self, block: Block) -> list[Literal]:
        """Return the entry conditions on the anchor and targets alone."""
        return [literal for literal in block.entry if keeper(block, literal.arguments) == block.anchor]

    def entry_at_fill(self, block: Block, slot: str) -> list[Literal]:
        """Return the entry conditions whose last slot is this one, and the feasibility that is known by then."""
        mine = [literal for literal in block.entry if keeper(block, literal.arguments) == slot]
        known = {slot, block.anchor} | {a for literal in mine for a in literal.arguments}
        early = [
            literal
            for literal in self.entry_at_begin(block)
            if literal.predicate.static and set(literal.arguments) <= known
        ]
        return mine + early

    def exit_at(self, block: Block, slot: str) -> list[Literal]:
        """Return the exit conditions whose last slot is this one; for the anchor, those on it and targets alone."""
        return [literal for literal in block.exit if keeper(block, literal.arguments) == slot]

    def bound_by(self, block: Block) -> dict[str, str]:
        """Return the targets that fills bind, with the first slot whose fill mentions each."""
        targets = {target.name for target in block.targets}
        bound: dict[str, str] = {}
        for slot in block.others:
            for literal in self.entry_at_fill(block, slot.name) + self.exit_at(block, slot.name):
                for argument in literal.arguments:
                    if argument in targets:
                        bound.setdefault(argument, slot.name)
        return bound

    def maintained_by(self, block: Block, slot: str) -> list[Literal]:
        """Return the exit conditions that the hold of the block maintains and the token in this slot carries."""
        return [literal for literal in block.maintained_exit if keeper(block, literal.arguments) == slot]

    def unified(self, old: Block, slot_before: str, new: Block, slot: str) -> dict[str, str]:
        """Return roles of the old block that must equal roles of the new one.

        The old block maintains a condition, e.g. behind(hand, object, region), for its own targets only. So an entry
        condition of the new block on the same predicate names the same tokens.
        """
        same: dict[str, str] = {}
        entry = self.entry_at_begin(new) if slot == new.anchor else self.entry_at_fill(new, slot)
        for kept in self.maintained_by(old, slot_before):
            for wanted in entry:
                if wanted.predicate is kept.predicate and wanted.positive:
                    pairs = dict(zip(kept.arguments, wanted.arguments, strict=True))
                    if pairs.get(slot_before) == slot:
                        same |= pairs
        return same

    def locked(self, block: Block) -> tuple[Target, ...]:
        """Return the targets of the block that some block may change."""
        return locked_targets(self.vocabulary.domain, block)

    def claimable(self, block: Block, slot: str) -> bool:
        """Say whether the token in this slot may be the anchor of a block with several slots."""
        mine = block.slot(slot).object_class
        return any(
            other.others
            and self.vocabulary.domain.relations.can_share_token(mine, other.slot(other.anchor).object_class)
            for other in self.vocabulary.domain.blocks
        )

    def _reads(self, block: Block, slot: str) -> Iterator[set[str]]:
        mine = block.slot(slot).object_class
        for other in self.vocabulary.domain.blocks:
            for target in self.locked(other):
                sort = target.sort
                if not isinstance(sort, SymbolSort) and self.vocabulary.domain.relations.can_share_token(mine, sort):
                    yield set(target.reads)

    def readable(self, block: Block, slot: str) -> bool:
        """Say whether some block may read the token in this slot as a locked target."""
        return any(True for _ in self._reads(block, slot))

    def changes(self, block: Block, slot: str) -> bool:
        """Say whether the block changes a property that a reader of the token in this slot reads."""
        written = set(block.writes.get(slot, ()))
        return any(written & read for read in self._reads(block, slot))

    def disturbs(self, block: Block, slot: str) -> bool:
        """Say whether the block changes such a property until it ends. A block that holds stops at its exit."""
        return not block.hold and self.changes(block, slot)

    def to_keep_apart(self, block: Block, bound: set[str]) -> list[tuple[str, str]]:
        """Return the (slot, target) pairs that need a condition which forbids one token in both.

        A pair in a common static condition needs none, because feasibility is computed for different tokens.
        """
        pairs = []
        for slot in block.slots:
            for target in block.targets:
                sort = target.sort
                if isinstance(sort, SymbolSort) or not {slot.name, target.name} <= bound:
                    continue
                guarded = any(
                    literal.positive and {slot.name, target.name} <= set(literal.arguments)
                    for literal in block.static_entry
                )
                if not guarded and self.vocabulary.domain.relations.can_share_token(slot.object_class, sort):
                    pairs.append((slot.name, target.name))
        return pairs
