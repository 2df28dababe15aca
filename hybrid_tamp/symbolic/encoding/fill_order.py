"""The order in which the slots of a block are filled.

When a token leaves a block that maintains conditions, e.g. behind(hand, object, region), its `fill` deletes
the conditions. If an entry condition mentions this token and another slot, this token is therefore the last to fill.
"""

from dataclasses import replace

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.symbolic.encoding.assignment import keeper


def order_slots(domain: Domain) -> Domain:
    """Return the domain in which the slots of each block, except the anchor, are in the order of their fills."""
    blocks = tuple(_order_block(domain, block) for block in domain.blocks)
    if all(one is other for one, other in zip(blocks, domain.blocks, strict=True)):
        return domain
    return replace(domain, blocks=blocks)


def _order_block(domain: Domain, block: Block) -> Block:
    names = [slot.name for slot in block.others]
    earlier = {name: _needed_by(domain, block, name) for name in names}
    ordered: list[str] = []
    while len(ordered) < len(names):
        waiting = [name for name in names if name not in ordered]
        # Slots that wait for each other stay in the declared order.
        free = [name for name in waiting if earlier[name] <= {*ordered, name}]
        ordered.append((free or waiting)[0])
    if ordered == names:
        return block
    return replace(block, slots=(block.slot(block.anchor), *map(block.slot, ordered)))


def _needed_by(domain: Domain, block: Block, slot: str) -> set[str]:
    """Return the slots that must be filled earlier, because the slot's token deletes conditions that they share."""
    lost = _maintained(domain, block, slot)
    others = {each.name for each in block.others}
    return {
        argument
        for literal in block.entry
        for kept, role in lost
        if literal.positive and literal.predicate is kept.predicate
        if literal.arguments[kept.arguments.index(role)] == slot
        for argument in others & set(literal.arguments)
    } - {slot}


def _maintained(domain: Domain, block: Block, slot: str) -> list[tuple[Literal, str]]:
    """Return the conditions that end when a token fills the slot, with the token's role in the conditions."""
    sources = [source for source, target in domain.network.edges if target == (block.name, slot)]
    return [
        (literal, role)
        for name, role in sources
        for literal in domain.block_by_name[name].maintained_exit
        if keeper(domain.block_by_name[name], literal.arguments) == role
    ]
