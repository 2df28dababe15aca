"""Relations over symbols. A relation is declared by the rows (tuples) of symbols for which the relation holds."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.errors import Issue
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray

Row = tuple[str, ...]


@dataclass(frozen=True)
class Membership:
    """The margin of a relation over symbols, which is 0 for a row of the relation and -1 otherwise."""

    rows: frozenset[Row]

    def __call__(self, state: State, *symbols: object) -> FloatArray:
        """Return the margin for a row of symbols or tokens, shape ``(...)``. Rows refer to tokens by name."""
        row = tuple(getattr(symbol, "name", symbol) for symbol in symbols)
        return np.full(state.values.shape[:-1], 0.0 if row in self.rows else -1.0)


def order_rows(rows: Iterable[Row], sorts: Sequence[Row]) -> tuple[Row, ...]:
    """Return the rows without duplicates, sorted by the order of the symbols in each sort."""
    orders = [{symbol: index for index, symbol in enumerate(symbols)} for symbols in sorts]

    def place(row: Row) -> list[int]:
        return [order.get(symbol, -1) for order, symbol in zip(orders, row, strict=False)]

    return tuple(sorted(set(rows), key=place))


def row_faults(name: str, rows: Iterable[Row], sorts: Sequence[Row], lawful: bool) -> Iterator[Issue]:
    """Yield a fault for each row that does not have exactly one symbol of each sort.

    Args:
        name: name of the predicate.
        rows: rows of the predicate.
        sorts: symbols of each parameter. A parameter without symbols takes the names of tokens.
        lawful: whether the predicate may have rows.
    """
    if not lawful:
        yield Issue(name, "a predicate with rows must be static and must have only symbol parameters")
        return
    for row in rows:
        right = (not symbols or symbol in symbols for symbol, symbols in zip(row, sorts, strict=False))
        if len(row) != len(sorts) or not all(right):
            yield Issue(name, "a row of a relation must have one symbol of each parameter's sort", repr(row))
