"""Assignment of a block's conditions to operators.

A condition belongs to an operator that has parameters for all roles of the condition. If the anchor is the only slot
in the condition, the operator is `begin`. Otherwise, the operator is the `fill` of the last slot in the condition. If
several fills mention the same target, the first fill binds the target. Later fills and `begin` use the same target.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, product

from hybrid_tamp.model.block import Block, Slot, Target
from hybrid_tamp.model.predicate import Literal, SymbolSort
from hybrid_tamp.symbolic.encoding.assignment import keeper, locked_targets
from hybrid_tamp.symbolic.encoding.vocabulary import Vocabulary


@dataclass(frozen=True, eq=False)
class Conditions:
    """Assigns the conditions of a domain's blocks to operators."""

    vocabulary: Vocabulary

    def entry_at_begin(self, block: Block) -> list[Literal]:
        """Return the entry conditions that mention no slot except the anchor."""
        return [literal for literal in block.entry if keeper(block, literal.arguments) == block.anchor]

    def entry_at_fill(self, block: Block, slot: str) -> list[Literal]:
        """Return the entry conditions that a `fill` checks, including feasibility conditions on known roles."""
        mine = [literal for literal in block.entry if keeper(block, literal.arguments) == slot]
        known = {slot, block.anchor} | {a for literal in mine for a in literal.arguments}
        early = [c for c in self.entry_at_begin(block) if c.predicate.static and set(c.arguments) <= known]
        return mine + early

    def exit_at(self, block: Block, slot: str) -> list[Literal]:
        """Return the exit conditions that belong to a slot (see `keeper`)."""
        return [literal for literal in block.exit if keeper(block, literal.arguments) == slot]

    def bound_by(self, block: Block) -> dict[str, str]:
        """Return a dictionary that maps each target to the first slot whose `fill` mentions the target."""
        return self._bound_by[block.name]

    @cached_property
    def _bound_by(self) -> dict[str, dict[str, str]]:
        # Every operator of a block asks for its targets.
        return {block.name: self._find_bound(block) for block in self.vocabulary.domain.blocks}

    def _find_bound(self, block: Block) -> dict[str, str]:
        targets = {target.name for target in block.targets}
        bound: dict[str, str] = {}
        for slot in block.others:
            for literal in self.entry_at_fill(block, slot.name) + self.exit_at(block, slot.name):
                for argument in literal.arguments:
                    if argument in targets:
                        bound.setdefault(argument, slot.name)
        return bound

    def maintained_by(self, block: Block, slot: str) -> list[Literal]:
        """Return the maintained exit conditions that belong to a slot (see `keeper`)."""
        return [literal for literal in block.maintained_exit if keeper(block, literal.arguments) == slot]

    def unified(self, old: Block, slot_before: str, new: Block, slot: str) -> dict[str, str]:
        """Return a dictionary that maps roles of the old block to roles of the new block with the same token.

        The old block maintains a condition, e.g. behind(hand, object, region), for its own targets only. So an entry
        condition of the new block on the same predicate must name the same tokens.
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
        """Return the targets with a property that some block may change while this block reads the property."""
        return locked_targets(self.vocabulary.domain, block)

    def claimable(self, block: Block, slot: str) -> bool:
        """Return whether a token in this slot may also be the anchor of a block with several slots."""
        domain, mine = self.vocabulary.domain, block.slot(slot).object_class
        anchors = (other.slot(other.anchor).object_class for other in domain.blocks if other.others)
        return any(domain.relations.can_share_token(mine, anchor) for anchor in anchors)

    def _reads(self, block: Block, slot: str) -> Iterator[set[str]]:
        mine = block.slot(slot).object_class
        for other in self.vocabulary.domain.blocks:
            for target in self.locked(other):
                sort = target.sort
                if not isinstance(sort, SymbolSort) and self.vocabulary.domain.relations.can_share_token(mine, sort):
                    yield set(target.reads)

    def readable(self, block: Block, slot: str) -> bool:
        """Return whether some block may read the token of this slot as a locked target."""
        return any(True for _ in self._reads(block, slot))

    def changes(self, block: Block, slot: str) -> bool:
        """Return whether the block changes a property that another block may read from the token of the slot."""
        written = set(block.writes.get(slot, ()))
        return any(written & read for read in self._reads(block, slot))

    def read_until_begin(self, block: Block) -> list[str]:
        """Return the slots with tokens that the block changes, and that its other tokens may read until it begins."""
        return self._read_until_begin[block.name]

    @cached_property
    def _read_until_begin(self) -> dict[str, list[str]]:
        return {
            block.name: [
                s.name for s in block.others if self.changes(block, s.name) and self._read_by_partners(block, s)
            ]
            for block in self.vocabulary.domain.blocks
        }

    def _read_by_partners(self, block: Block, slot: Slot) -> bool:
        """Return whether a token that enters another slot of the block may read the slot's token before."""
        domain = self.vocabulary.domain
        sources = [domain.network.sources((block.name, other.name)) for other in block.slots if other is not slot]
        reading = (domain.block_by_name[name] for ends in sources for name, _ in ends)
        return any(self._may_be(slot, target) for old in reading for target in self.locked(old))

    def _may_be(self, slot: Slot, target: Target) -> bool:
        """Return whether the token of a slot may be the target of another block."""
        sort = target.sort
        shared = self.vocabulary.domain.relations.can_share_token
        return not isinstance(sort, SymbolSort) and shared(slot.object_class, sort)

    def read_before(self, old: Block, new: Block) -> Iterator[dict[str, str]]:
        """Yield dictionaries from targets of the anchor's old block to slots of the new block.

        In each dictionary, these targets are the tokens in these slots, and the new block changes these tokens. The
        first dictionary is empty.
        """
        known = self.unified(old, old.anchor, new, new.anchor)
        changed = [new.slot(name) for name in self.read_until_begin(new)]
        choices: list[list[str | None]] = [
            [None, *(slot.name for slot in changed if target.name not in known and self._may_be(slot, target))]
            for target in self.locked(old)
        ]
        for chosen in product(*choices):
            read = {t.name: s for t, s in zip(self.locked(old), chosen, strict=True) if s is not None}
            if len(set(read.values())) == len(read):
                yield read

    def disturbs(self, block: Block, slot: str) -> bool:
        """Return whether `changes` is true and the block continues to change the token until the block ends."""
        # A block with a hold stops changing the property at its exit.
        return not block.hold and self.changes(block, slot)

    def to_keep_apart(self, block: Block, bound: set[str]) -> list[tuple[str, str]]:
        """Return the pairs of roles, at least one of them a target, that need the condition `distinct`."""
        pairs: Iterator[tuple[Slot | Target, Slot | Target]] = combinations((*block.slots, *block.targets), 2)
        return [
            (one.name, other.name)
            for one, other in pairs
            if isinstance(other, Target) and {one.name, other.name} <= bound and self._may_coincide(block, one, other)
        ]

    def bound_late(self, block: Block) -> list[str]:
        """Return the slots, except the anchor, that may have the token of a target that only `begin` binds."""
        bound = self.bound_by(block)
        late = [target for target in block.targets if target.name not in bound]
        return [slot.name for slot in block.others if any(self._may_coincide(block, slot, target) for target in late)]

    def _may_coincide(self, block: Block, one: Slot | Target, other: Target) -> bool:
        first = one.object_class if isinstance(one, Slot) else one.sort
        if isinstance(first, SymbolSort) or isinstance(other.sort, SymbolSort):
            return False
        # A pair that shares a static condition is left out, because feasibility is computed for different tokens only.
        names = {one.name, other.name}
        if any(c.positive and names <= set(c.arguments) for c in block.static_entry):
            return False
        return self.vocabulary.domain.relations.can_share_token(first, other.sort)
