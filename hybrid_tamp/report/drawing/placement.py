"""The arrangement of blocks in columns and rows.

The direction of the wires determines the columns. A search with decreasing randomness finds the rows and the order of
the slots in each block, so that wires are short and seldom cross.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from hybrid_tamp.report.drawing.columns import find_columns
from hybrid_tamp.report.drawing.cost import PlacementCost
from hybrid_tamp.report.drawing.sizes import Sizes

_Cells = npt.NDArray[np.int64]
_Orders = tuple[tuple[str, ...], ...]
_STEPS, _BATCH = 40, 48
"""Number of steps of the search, and number of changed placements that each step compares."""
_HOTTEST, _COLDEST = 30.0, 0.5
"""Randomness in the choice of a placement at the first and at the last step, in units of cost."""
_REORDERED = 0.25
"""Share of the changes that swap two slots of a block."""


@dataclass(frozen=True)
class Placement:
    """Where blocks stand.

    Attributes:
        blocks: names of the blocks.
        cells: (column, row) of each block.
        orders: slots of each block, from top to bottom.
    """

    blocks: tuple[str, ...]
    cells: tuple[tuple[int, int], ...]
    orders: tuple[tuple[str, ...], ...]

    @cached_property
    def cell_of(self) -> dict[str, tuple[int, int]]:
        """Maps each block to its (column, row)."""
        return dict(zip(self.blocks, self.cells, strict=True))

    @cached_property
    def order_of(self) -> dict[str, tuple[str, ...]]:
        """Maps each block to its slots, from top to bottom."""
        return dict(zip(self.blocks, self.orders, strict=True))

    @cached_property
    def shape(self) -> tuple[int, int]:
        """Numbers of columns and rows."""
        return max((c for c, _ in self.cells), default=0) + 1, max((r for _, r in self.cells), default=0) + 1


def place_boxes(sizes: Sizes, seed: int, count: int) -> tuple[Placement, ...]:
    """Return the cheapest placements that a search meets, at most `count` of which have different cells.

    The slots have the cheapest order or the order of their declaration.
    """
    return _Search(sizes, seed).run(count) if sizes.diagram.boxes else (Placement((), (), ()),)


class _Search:
    """A search for a cheap placement of one diagram."""

    def __init__(self, sizes: Sizes, seed: int) -> None:
        self._boxes = sizes.diagram.boxes
        self._rng = np.random.default_rng(seed)
        self._cost = PlacementCost(sizes)
        found = find_columns(sizes.diagram)
        self._columns = np.array([found[box.block] for box in self._boxes])
        self._rows = int(np.bincount(self._columns).max()) + 1

    def run(self, count: int) -> tuple[Placement, ...]:
        """Return the cheapest placements that the search meets, as described for `place_boxes`."""
        rows = [int((self._columns[:index] == column).sum()) for index, column in enumerate(self._columns)]
        here = np.stack([self._columns, rows], axis=1), tuple(box.slots for box in self._boxes)
        met: dict[bytes, tuple[float, Placement]] = {}
        for heat in np.geomspace(_HOTTEST, _COLDEST, _STEPS):
            near = [here, *(self._change(*here) for _ in range(_BATCH))]
            costs = self._cost.of(np.array([cells for cells, _ in near]), [orders for _, orders in near])
            for cost, (cells, orders) in zip(costs.tolist(), near, strict=True):
                if cost < met.get(cells.tobytes(), (np.inf,))[0]:
                    met[cells.tobytes()] = (cost, self._placement(cells, orders))
            here = near[int(np.argmin(costs - heat * self._rng.gumbel(size=len(near))))]
        best = sorted(met.values(), key=lambda each: each[0])
        declared = tuple(box.slots for box in self._boxes)
        found = [each for _, placement in best[:count] for each in (placement, replace(placement, orders=declared))]
        return tuple(dict.fromkeys(found))

    def _change(self, cells: _Cells, orders: _Orders) -> tuple[_Cells, _Orders]:
        """Move a block to another row, where it changes places with the block there, or swap two slots of a block."""
        index = int(self._rng.integers(len(cells)))
        order = [*orders[index]]
        if self._rng.random() < _REORDERED and len(order) > 1:
            one, other = self._rng.choice(len(order), 2, replace=False)
            order[one], order[other] = order[other], order[one]
            return cells, (*orders[:index], tuple(order), *orders[index + 1 :])
        moved = cells.copy()
        moved[index, 1] = self._rng.integers(self._rows)
        moved[(cells == moved[index]).all(axis=1)] = cells[index]
        return moved, orders

    def _placement(self, cells: _Cells, orders: _Orders) -> Placement:
        rows = np.unique(cells[:, 1]).tolist()
        names = tuple(box.block for box in self._boxes)
        return Placement(names, tuple((column, rows.index(row)) for column, row in cells.tolist()), orders)
