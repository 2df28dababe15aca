"""Matching of places to things at the least total cost."""

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.motion.arrays import FloatArray


def cheapest_matching(costs: FloatArray) -> list[int] | None:
    """Return for each row a column of its own such that the sum of the costs is least, or None if there is no way.

    Rows are matched one by one, each along the cheapest path of changes to the earlier ones (Kuhn 1955, with the
    potentials of Edmonds and Karp 1972, which keep the changes' costs from being negative).

    Args:
        costs: costs ``(rows, columns)``, infinite where a row and a column do not fit.
    """
    rows, columns = costs.shape
    if rows > columns:
        return None
    of_row, of_column = np.zeros(rows), np.zeros(columns)
    owner = np.full(columns, -1)
    for row in range(rows):
        reduced, before = np.full(columns, np.inf), np.full(columns, -1)
        done = np.zeros(columns, dtype=bool)
        at, column, length = row, -1, 0.0
        while at >= 0:
            through = length + costs[at] - of_row[at] - of_column
            better = ~done & (through < reduced)
            reduced[better], before[better] = through[better], column
            open_ends = np.where(done, np.inf, reduced)
            column = int(np.argmin(open_ends))
            length = float(open_ends[column])
            if not np.isfinite(length):
                return None
            done[column] = True
            at = int(owner[column])
        _move_prices(of_row, of_column, owner, reduced, done, row, length)
        while column >= 0:
            previous = int(before[column])
            owner[column] = row if previous < 0 else owner[previous]
            column = previous
    return [int(np.flatnonzero(owner == row)[0]) for row in range(rows)]


def _move_prices(
    of_row: FloatArray,
    of_column: FloatArray,
    owner: NDArray[np.int_],
    reduced: FloatArray,
    done: NDArray[np.bool_],
    row: int,
    length: float,
) -> None:
    """Change the potentials so that no reduced cost is negative and those on the path are zero."""
    of_row[row] += length
    for column in np.flatnonzero(done):
        if owner[column] >= 0:
            of_row[owner[column]] += length - reduced[column]
        of_column[column] -= length - reduced[column]
