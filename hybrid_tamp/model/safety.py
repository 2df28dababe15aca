"""Safety factors of feasibility facts, and the replacement of predicates in blocks.

A physical bound states what is possible at best, e.g. the load at which a grasp slips. A safety factor of more than 1
makes a fact stricter than its physical bound, because a load should stay below the bound. A task chooses its safety
factors. So a fact that fails only because of its safety factor proves nothing.
"""

from collections.abc import Mapping
from dataclasses import replace

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Literal, Predicate


def with_factor(predicate: Predicate, factor: float) -> Predicate:
    """Return a predicate that has a safety factor with another factor, which must be at least 1."""
    assert predicate.safety is not None, "the predicate must have a safety factor"
    return replace(predicate, safety=replace(predicate.safety, factor=factor))


def with_factors(predicates: Mapping[str, Predicate], factors: Mapping[str, float]) -> dict[str, Predicate]:
    """Return the predicates whose safety factor changes, with the new factor.

    Args:
        predicates: maps each name to its predicate.
        factors: maps names of predicates with a safety factor to factors, which are at least 1.
    """
    return {
        name: with_factor(predicates[name], factor)
        for name, factor in factors.items()
        if (old := predicates[name].safety) is not None and old.factor != factor
    }


def use_predicates(block: Block, changed: Mapping[str, Predicate]) -> Block:
    """Return the block in which each condition on a predicate in `changed` uses the predicate of the same name there.

    If nothing changes, the same block is returned.
    """

    def of(old: Predicate) -> Predicate:
        return changed.get(old.name, old)

    def literals(some: tuple[Literal, ...]) -> tuple[Literal, ...]:
        return tuple(
            each if of(each.predicate) is each.predicate else replace(each, predicate=of(each.predicate))
            for each in some
        )

    entry, leaving, throughout = map(literals, (block.entry, block.exit, block.invariants))
    keeps = tuple(map(of, block.keeps))
    if (entry, leaving, throughout, keeps) == (block.entry, block.exit, block.invariants, block.keeps):
        return block
    waived = dict(zip(literals(tuple(block.waived)), block.waived.values(), strict=True))
    return replace(block, entry=entry, exit=leaving, invariants=throughout, waived=waived, keeps=keeps)
