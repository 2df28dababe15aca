"""Preferences of blocks: static conditions that a plan meets if possible.

A preference makes the search smaller, e.g. because each hand stays on its side of a box. It is not a law: if the
preferences leave no plan, the planner ignores them.
"""

from dataclasses import replace

from hybrid_tamp.model.task import Task


def prefer(task: Task) -> Task | None:
    """Return the task in which preferences are entry conditions, or None if no block has preferences."""
    blocks = [
        replace(block, entry=(*block.entry, *block.preferences)) for block in task.domain.blocks if block.preferences
    ]
    predicates = [literal.predicate for block in blocks for literal in block.preferences]
    return task.replaced(domain=task.domain.with_blocks(blocks, predicates)) if blocks else None
