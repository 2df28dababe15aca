"""Safety factors of feasibility facts, and the replacement of predicates in blocks.

A physical bound states what is possible at best, e.g. the load at which a grasp slips. A safety factor of more than 1
makes a fact stricter than its physical bound, because a load should stay below the bound. A task can choose other
safety factors. So a fact that fails only because of its safety factor does not prove that there is no plan.
"""

from collections.abc import Mapping
from dataclasses import replace

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Literal, Predicate


def with_factor(predicate: Predicate, factor: float) -> Predicate:
    """Return a predicate with a new safety factor, which must be at least 1."""
    assert predicate.safety is not None, "the predicate must have a safety factor"
    return replace(predicate, safety=replace(predicate.safety, factor=factor))


def with_factors(predicates: Mapping[str, Predicate], factors: Mapping[str, float]) -> dict[str, Predicate]:
    """Return a new version of each predicate whose safety factor changes.

    Args:
        predicates: maps each name to its predicate.
        factors: maps names of predicates to new safety factors of at least 1. Predicates without a factor are ignored.
    """
    return {
        name: with_factor(predicates[name], factor)
        for name, factor in factors.items()
        if (old := predicates[name].safety) is not None and old.factor != factor
    }


def use_predicates(block: Block, changed: Mapping[str, Predicate]) -> Block:
    """Return the block with the predicates in `changed` in place of the predicates with the same names.

    If no predicate of the block changes, the same block is returned.
    """

    def of(old: Predicate) -> Predicate:
        return changed.get(old.name, old)

    def literals(some: tuple[Literal, ...]) -> tuple[Literal, ...]:
        return tuple(
            each if of(each.predicate) is each.predicate else replace(each, predicate=of(each.predicate))
            for each in some
        )

    # Conditions in `allowed_contacts` are not static, and only static predicates have safety factors.
    entry, preferred, leaving, throughout = map(
        literals, (block.entry, block.preferences, block.exit, block.invariants)
    )
    keeps = tuple(map(of, block.keeps))
    own = (block.entry, block.preferences, block.exit, block.invariants, block.keeps)
    if (entry, preferred, leaving, throughout, keeps) == own:
        return block
    waived = dict(zip(literals(tuple(block.waived)), block.waived.values(), strict=True))
    return replace(
        block, entry=entry, preferences=preferred, exit=leaving, invariants=throughout, waived=waived, keeps=keeps
    )
