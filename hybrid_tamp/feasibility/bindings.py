"""Bindings that assign tokens and symbols to a block's roles and that satisfy feasibility conditions."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import islice

from hybrid_tamp.model.bindings import Choices, enumerate_bindings, order_roles
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.facts import StaticFacts
from hybrid_tamp.model.predicate import Literal, Value

Bound = dict[str, Value]
"""Maps each role to its value."""

MOST = 50_000
"""Largest number of bindings of one block that are examined."""


class TooMany(Exception):
    """Raised if a block has more than `MOST` bindings to examine."""


def order_conditions(block: Block) -> tuple[Literal, ...]:
    """Return the block's feasibility conditions. Conditions on symbols exclude most bindings, so they come first."""
    return tuple(sorted(block.static_entry, key=lambda literal: literal.predicate.rows is None))


def find_feasible(facts: StaticFacts, conditions: Iterable[Literal], allowed: Choices) -> list[Bound]:
    """Return all bindings of the conditions' roles with which every condition holds. No token fills two roles.

    Raises:
        TooMany: more than `MOST` bindings satisfy one of the conditions.
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
    """Yield every extension of the given bindings to all roles. No token fills two roles."""
    for bound in bounds:
        rest = {role: values for role, values in allowed.items() if role not in bound}
        yield from enumerate_bindings({**{role: (value,) for role, value in bound.items()}, **rest})
