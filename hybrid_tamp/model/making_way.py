"""Blocks with which a resting token makes way for other movements."""

from hybrid_tamp.model.block import Block


def makes_way(block: Block) -> bool:
    """Return whether a block only moves a single token along a path.

    The task planner needs no such block, and for an observer, such a block would explain every movement.
    """
    return len(block.slots) == 1 and block.path == block.anchor and not block.targets and not block.entry
