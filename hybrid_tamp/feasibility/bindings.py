"""Which tokens and symbols could fill a block's roles, as far as facts tell that nothing changes."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import islice, product

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import Literal, Predicate, Value
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import different

Choices = dict[str, tuple[Value, ...]]
"""Role to the values that it may have."""
Bound = dict[str, Value]
"""Role to its value."""

MOST = 50_000
"""So many bindings of a block are looked at."""


class TooMany(Exception):
    """A block has more bindings than are looked at."""


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


def choices(task: Task, block: Block, fixed: Mapping[str, Value]) -> Choices:
    """Return what each role may be by its class or sort alone, and by what is fixed; an empty tuple where nothing."""
    every = {role: task.values_of(sort) for role, sort in block.roles.items()}
    return {
        role: tuple(value for value in values if role not in fixed or value == fixed[role])
        for role, values in every.items()
    }


def static_entry(block: Block) -> tuple[Literal, ...]:
    """Return the block's feasibility conditions, those over symbols alone first: they leave the fewest choices."""
    return tuple(sorted(block.static_entry, key=lambda literal: literal.predicate.rows is None))


def feasible(margins: Margins, literals: Iterable[Literal], allowed: Choices) -> list[Bound]:
    """Return the bindings of the literals' roles under which all of them hold, tokens different from each other.

    Raises:
        TooMany: there are more than `MOST`.
    """
    found: list[Bound] = [{}]
    for literal in literals:
        every = (more for bound in found for more in _extended(margins, literal, bound, allowed))
        found = list(islice(every, MOST + 1))
        if len(found) > MOST:
            raise TooMany
    return found


def completed(bounds: Iterable[Bound], allowed: Choices) -> Iterator[Bound]:
    """Yield every way to bind the remaining roles, tokens different from each other."""
    for bound in bounds:
        missing = [role for role in allowed if role not in bound]
        for values in product(*(allowed[role] for role in missing)):
            whole = bound | dict(zip(missing, values, strict=True))
            if different(whole.values()):
                yield whole


def _extended(margins: Margins, literal: Literal, bound: Bound, allowed: Choices) -> Iterator[Bound]:
    return (more for more in extensions(literal, bound, allowed) if margins.of(literal, more) >= 0)


def extensions(literal: Literal, bound: Bound, allowed: Choices) -> Iterator[Bound]:
    """Yield every way to bind a literal's roles, tokens different; of one over symbols alone, those that hold."""
    roles = [role for role in dict.fromkeys(literal.arguments) if role in allowed and role not in bound]
    rows: Iterable[tuple[Value, ...]]
    if literal.positive and literal.predicate.rows is not None and len(roles) == len(literal.arguments):
        rows = (row for row in literal.predicate.rows if all(v in allowed[r] for r, v in zip(roles, row, strict=True)))
    else:
        rows = product(*(allowed[role] for role in roles))
    for values in rows:
        more = bound | dict(zip(roles, values, strict=True))
        if different(more.values()):
            yield more
