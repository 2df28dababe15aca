"""Matching of rows to columns at the least total cost."""

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray


def cheapest_matching(costs: FloatArray) -> list[int] | None:
    """Return a different column for each row such that the sum of the costs is least, or None if there is no matching.

    The rows are matched one by one. Each is matched along the cheapest path of changes to the earlier ones (Kuhn
    1955). The potentials of Edmonds and Karp (1972) keep the costs of the changes from being negative.

    Args:
        costs: costs ``(rows, columns)``, infinite if a row and a column do not fit.
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
        # With these changes no reduced cost is negative, and those on the path are zero.
        owned = np.flatnonzero(done & (owner >= 0))
        of_row[row] += length
        of_row[owner[owned]] += length - reduced[owned]
        of_column[done] -= length - reduced[done]
        while column >= 0:
            previous = int(before[column])
            owner[column] = row if previous < 0 else owner[previous]
            column = previous
    return [int(np.flatnonzero(owner == row)[0]) for row in range(rows)]
