"""Which tokens and symbols can take a block's roles, as far as feasibility facts decide."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import islice

from hybrid_tamp.model.bindings import Choices, enumerate_bindings, order_roles
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.facts import StaticFacts
from hybrid_tamp.model.predicate import Literal, Value

Bound = dict[str, Value]
"""Role to its value."""

MOST = 50_000
"""Largest number of bindings of a block that are examined."""


class TooMany(Exception):
    """A block has more bindings than are examined."""


def order_conditions(block: Block) -> tuple[Literal, ...]:
    """Return the block's feasibility conditions, those over symbols alone first: they leave the fewest choices."""
    return tuple(sorted(block.static_entry, key=lambda literal: literal.predicate.rows is None))


def find_feasible(facts: StaticFacts, conditions: Iterable[Literal], allowed: Choices) -> list[Bound]:
    """Return the bindings of the conditions' roles to different tokens under which all conditions hold.

    Raises:
        TooMany: more than `MOST` bindings satisfy all conditions or some of them.
    """
    conditions = list(conditions)
    roles = {argument for literal in conditions for argument in literal.arguments}
    satisfied = dict.fromkeys(conditions, 0)

    def holds(literal: Literal, bound: Mapping[str, Value]) -> bool:
        if facts.margin(literal, bound) < 0:
            return False
        satisfied[literal] += 1
        if satisfied[literal] > MOST:
            raise TooMany
        return True

    choices = {role: values for role, values in order_roles(allowed, conditions).items() if role in roles}
    return list(islice(enumerate_bindings(choices, conditions, holds), MOST + 1))


def complete(bounds: Iterable[Bound], allowed: Choices) -> Iterator[Bound]:
    """Yield every way to bind the remaining roles to different tokens."""
    for bound in bounds:
        rest = {role: values for role, values in allowed.items() if role not in bound}
        yield from enumerate_bindings({**{role: (value,) for role, value in bound.items()}, **rest})
