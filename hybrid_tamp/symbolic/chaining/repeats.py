"""Copies of blocks, so that a token can pass from a block with several slots to the same block.

The encoding identifies an instance by its block and its anchor. If an edge leads from the anchor of a block with
several slots to the same anchor, two such instances of one anchor follow each other. The second instance belongs to a
copy of the block, and a third instance belongs to the block again.
"""

from collections.abc import Iterator
from dataclasses import replace

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import ReassignmentNetwork, SlotName
from hybrid_tamp.model.plan import TaskPlan, at
from hybrid_tamp.symbolic.chaining.chains import Chains
from hybrid_tamp.symbolic.pddl.naming import legal, unused


def copy_repeated(chains: Chains) -> Chains:
    """Return the chains with a copy of each block that may follow itself."""
    for block in chains.domain.blocks:
        end = (block.name, block.anchor)
        if block.others and chains.domain.network.allows(end, end):
            chains = _copy(chains, block)
    return chains


def _copy(chains: Chains, block: Block) -> Chains:
    domain = chains.domain
    name = unused(legal(f"{block.name} again"), {legal(each.name) for each in domain.blocks})
    network = ReassignmentNetwork(dict.fromkeys(_edges(domain, block, name)))
    blocks = (*domain.blocks, replace(block, name=name))
    copied = replace(domain, blocks=blocks, network=network)
    return replace(chains, domain=copied, copies={**chains.copies, name: block.name})


def _edges(domain: Domain, block: Block, copy: str) -> Iterator[tuple[str, str]]:
    """Yield the edges of the network with a copy of a block. Anchors enter the copy only from the block itself."""
    for source, target in domain.network.edges:
        from_block, to_block = source[0] == block.name, target[0] == block.name
        if from_block and to_block:
            yield _end(source), _end((copy, target[1]))
            yield _end((copy, source[1])), _end(target)
            continue
        yield _end(source), _end(target)
        if from_block:
            yield _end((copy, source[1])), _end(target)
        elif to_block and target[1] != block.anchor:
            yield _end(source), _end((copy, target[1]))


def _end(slot: SlotName) -> str:
    return ".".join(slot)


def fold_repeats(chains: Chains, plan: TaskPlan) -> TaskPlan:
    """Replace each instance that directly follows an instance of the same block and anchor by one of the copy."""
    for copy, name in chains.copies.items():
        anchor = chains.domain.block_by_name[name].anchor
        ends: dict[str, float] = {}  # maps anchors to the ends of their instances of the block
        renamed = []
        for instance in sorted(plan.instances, key=lambda i: i.start):
            if instance.block == name:
                token = instance.slots[anchor]
                if token in ends and at(ends.pop(token), instance.start):
                    instance = replace(instance, block=copy)
                else:
                    ends[token] = instance.end
            renamed.append(instance)
        plan = replace(plan, instances=tuple(renamed))
    return plan
