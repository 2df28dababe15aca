"""Direct sampling on a regular grid, as in the paper. This exhaustive search serves as a baseline."""

from dataclasses import dataclass
from math import prod

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.midlevel.optimiser import Optimiser, Search
from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True)
class Grid(Optimiser):
    """The optimiser ``grid``.

    The grid has as many points on each axis as the budget of evaluations allows. The points include both bounds.

    Attributes:
        batch: number of candidates per batch, at least 1.

    Raises:
        InputError: if the batch is below 1.
    """

    batch: int = 256

    def __post_init__(self) -> None:
        """Check the size of a batch."""
        if self.batch < 1:
            raise InputError([Issue("batch", "must be at least 1 candidate", str(self.batch))])

    def sample(self, search: Search, rng: np.random.Generator) -> str:
        """Evaluate the default point and all points of the grid. The random generator is not used."""
        # The default point takes one evaluation.
        counts = axis_counts(search.k, search.budget.evaluations - 1)
        axes = [np.linspace(0.0, 1.0, n) if n > 1 else at[None] for n, at in zip(counts, search.start, strict=True)]
        size = prod(counts)
        for begin in range(0, size, self.batch):
            search.evaluate(_points(axes, np.arange(begin, min(begin + self.batch, size))))
        return "all sampled"


def axis_counts(k: int, evaluations: int) -> tuple[int, ...]:
    """Return the number of grid points on each of k axes. The grid has at most ``evaluations`` points.

    The numbers differ by at most 1, and earlier axes have the larger numbers. A variable whose axis has only one point
    keeps its default.
    """
    least = 1
    while k > 0 and (least + 1) ** k <= evaluations:
        least += 1
    counts = [least] * k
    for axis in range(k):
        if prod(counts) // least * (least + 1) <= evaluations:
            counts[axis] += 1
    return tuple(counts)


def _points(axes: list[FloatArray], indices: np.ndarray) -> FloatArray:
    """Return the grid points with the given flat indices, in the unit cube. Shape ``(n, k)``."""
    if not axes:
        return np.empty((len(indices), 0))
    places = np.unravel_index(indices, [len(axis) for axis in axes])
    return np.stack([axis[place] for axis, place in zip(axes, places, strict=True)], axis=1)
