"""From where tokens may come to the slots of a block, along with the anchor or on their own."""

from dataclasses import dataclass

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.symbolic.encoding.conditions import Conditions


@dataclass(frozen=True, eq=False)
class Sources:
    """The ways into the slots of a domain's blocks."""

    domain: Domain
    conditions: Conditions

    def of(self, block: Block, slot: str, along: bool) -> list[tuple[Block, str]]:
        """Return the slots from which a token comes to a slot, along with the anchor or not."""
        found = []
        for name, before in self.domain.network.sources((block.name, slot)):
            old = self.domain.block_by_name[name]
            together = (
                slot != block.anchor
                and before != old.anchor
                and self.domain.network.allows((name, old.anchor), (block.name, block.anchor))
            )
            # Where a condition says that the old anchor is the new one, there is no other way.
            bound = self.conditions.unified(old, before, block, slot).get(old.anchor) == block.anchor
            if (along and together) or (not along and not (together and bound)):
                found.append((old, before))
        return found

    def _may_be(self, block: Block, slot: str, other: Block, role: str) -> bool:
        """Say whether the token in a slot may be one in a slot of another block, too."""
        one, two = block.slot(slot).object_class, other.slot(role).object_class
        return self.domain.relations.can_share_token(one, two)

    def may_anchor(self, block: Block, slot: str) -> bool:
        """Say whether the token may be the anchor of a block with several slots."""
        return any(other.others and self._may_be(block, slot, other, other.anchor) for other in self.domain.blocks)
