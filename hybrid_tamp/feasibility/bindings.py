"""Which tokens and symbols can take a block's roles, as far as feasibility facts decide."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import islice

from hybrid_tamp.model.bindings import Choices, enumerate_bindings, order_roles
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Literal, Predicate, Value
from hybrid_tamp.model.task import Task

Bound = dict[str, Value]
"""Role to its value."""

MOST = 50_000
"""How many bindings of a block are examined at most."""


class TooMany(Exception):
    """A block has more bindings than are examined."""


class Margins:
    """The margins of a task's feasibility facts, each found once."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self._known: dict[tuple[Predicate, tuple[Value, ...]], float] = {}

    def of(self, literal: Literal, bound: Mapping[str, Value]) -> float:
        """Return the signed margin of a static literal whose roles are bound, in the initial state."""
        values = tuple(bound.get(argument, argument) for argument in literal.arguments)
        key = (literal.predicate, values)
        if key not in self._known:
            self._known[key] = float(literal.predicate.evaluate(self.task.state, *values))
        return self._known[key] if literal.positive else -self._known[key]


def static_entry(block: Block) -> tuple[Literal, ...]:
    """Return the block's feasibility conditions, those over symbols alone first: they leave the fewest choices."""
    return tuple(sorted(block.static_entry, key=lambda literal: literal.predicate.rows is None))


def feasible(margins: Margins, literals: Iterable[Literal], allowed: Choices) -> list[Bound]:
    """Return the bindings of the literals' roles under which all of them hold, tokens different from each other.

    Raises:
        TooMany: there are more than `MOST`, or more than that satisfy some of the literals.
    """
    literals = list(literals)
    roles = {argument for literal in literals for argument in literal.arguments}
    satisfied = dict.fromkeys(literals, 0)

    def holds(literal: Literal, bound: Mapping[str, Value]) -> bool:
        if margins.of(literal, bound) < 0:
            return False
        satisfied[literal] += 1
        if satisfied[literal] > MOST:
            raise TooMany
        return True

    choices = {role: values for role, values in order_roles(allowed, literals).items() if role in roles}
    return list(islice(enumerate_bindings(choices, literals, holds), MOST + 1))


def completed(bounds: Iterable[Bound], allowed: Choices) -> Iterator[Bound]:
    """Yield every way to bind the remaining roles, tokens different from each other."""
    for bound in bounds:
        yield from enumerate_bindings({**{role: (value,) for role, value in bound.items()}, **_rest(bound, allowed)})


def _rest(bound: Bound, allowed: Choices) -> Choices:
    return {role: values for role, values in allowed.items() if role not in bound}
