"""The lattice of lines on which wires run: between the columns, between the rows and above the bar.

Wires run vertically between columns only, and horizontally wherever no box stands. Lengths are in units of the grid.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from hybrid_tamp.model.network import SlotName
from hybrid_tamp.report.drawing.placement import Placement
from hybrid_tamp.report.drawing.sizes import Sizes

HORIZONTAL, VERTICAL = 0, 1
Step = tuple[int, int, float]
"""A neighbour of a node, the direction of the line to the neighbour, and the length of this line."""

MARGIN = 2
"""Distance between a box and the nearest vertical line."""


@dataclass(frozen=True, eq=False)
class Lattice:
    """The lines between the boxes of a placement.

    Attributes:
        sizes: sizes of the boxes.
        placement: columns and rows of the boxes.
        lanes: number of vertical lines in each space between columns. There are half as many horizontal lines between
            rows. The drawing leaves out the lines that no wire uses.
    """

    sizes: Sizes
    placement: Placement
    lanes: int

    @cached_property
    def tops(self) -> dict[str, int]:
        """Maps each block to the horizontal line at the top of its box."""
        heights = self._row_heights
        space = self.lanes // 2
        row_tops = [space + sum(heights[:row]) + space * row for row in range(len(heights) + 1)]
        return {block: row_tops[row] for block, (_, row) in self.placement.cell_of.items()} | {"": row_tops[-1]}

    @cached_property
    def _row_heights(self) -> list[int]:
        heights = [0] * self.placement.shape[1]
        for box in self.sizes.diagram.boxes:
            row = self.placement.cell_of[box.block][1]
            heights[row] = max(heights[row], self.sizes.height(box))
        return heights

    @cached_property
    def columns(self) -> int:
        """Number of vertical lines."""
        return (self.placement.shape[0] + 1) * self.lanes

    @cached_property
    def rows(self) -> int:
        """Number of horizontal lines. The bar lies below the last line."""
        return self.tops[""]

    def node(self, column: int, row: int) -> int:
        """Return the number of the node at which two lines cross."""
        return column * (self.rows + 1) + row

    def at(self, node: int) -> tuple[int, int]:
        """Return the (column, row) of the lines at a node. The column of a pin is that of the neighbouring line."""
        return divmod(self._beside.get(node, node), self.rows + 1)

    def is_bar(self, node: int) -> bool:
        """Return whether the node is on the edge of the bar."""
        return node < self._count and node % (self.rows + 1) == self.rows

    def side(self, node: int) -> int:
        """Return 1 for a pin on the right side of its slot, -1 for a pin on the left side, and 0 for other nodes."""
        return 0 if node < self._count else 2 * (node % 2) - 1

    @property
    def bar(self) -> range:
        """Nodes on the edge of the bar."""
        return range(self.rows, self._count, self.rows + 1)

    @cached_property
    def _count(self) -> int:
        return self.columns * (self.rows + 1)

    @cached_property
    def pins(self) -> dict[SlotName, tuple[int, ...]]:
        """Maps each slot to its nodes, which are alternately on the left and on the right side, from top to bottom."""
        found, number = {}, self._count + self._count % 2
        for slot in self._pin_rows:
            count = 2 * self.sizes.pins[slot]
            found[slot] = tuple(range(number, number + count))
            number += count
        return found

    @cached_property
    def _pin_rows(self) -> dict[SlotName, int]:
        return {
            slot: self.tops[box.block] + top
            for box in self.sizes.diagram.boxes
            for slot, top in self.sizes.tops(box, self.placement.order_of[box.block]).items()
        }

    @cached_property
    def _beside(self) -> dict[int, int]:
        """Maps each pin to the node to which it is connected."""
        found = {}
        for slot, pins in self.pins.items():
            column = self.placement.cell_of[slot[0]][0]
            for index, pin in enumerate(pins):
                right, row = index % 2, self._pin_rows[slot] + index // 2
                found[pin] = self.node((column + 1) * self.lanes - 1 + right, row)
        return found

    @cached_property
    def steps(self) -> dict[int, list[Step]]:
        """Maps each node to its neighbours."""
        found: dict[int, list[Step]] = {}

        def join(one: int, other: int, direction: int, length: float) -> None:
            found.setdefault(one, []).append((other, direction, length))
            found.setdefault(other, []).append((one, direction, length))

        behind, rows = self._behind_boxes, self._useful_rows
        for column in range(self.columns):
            gap, last = divmod(column, self.lanes)
            for row, below in pairwise(rows):
                join(self.node(column, row), self.node(column, below), VERTICAL, float(below - row))
                if last < self.lanes - 1:
                    join(self.node(column, row), self.node(column + 1, row), HORIZONTAL, 1.0)
                elif column + 1 < self.columns and (gap, row) not in behind:
                    length = self.sizes.width + 2.0 * MARGIN
                    join(self.node(column, row), self.node(column + 1, row), HORIZONTAL, length)
        for pin, node in self._beside.items():
            join(pin, node, HORIZONTAL, float(MARGIN))
        return found

    @cached_property
    def ahead(self) -> dict[tuple[int, int], list[tuple[int, float]]]:
        """Maps each pair of (node, direction) to the neighbours in this direction, with their distances."""
        return {
            (node, direction): [(other, length) for other, way, length in steps if way == direction]
            for node, steps in self.steps.items()
            for direction in (HORIZONTAL, VERTICAL)
        }

    @cached_property
    def lengths(self) -> dict[tuple[int, int], float]:
        """Maps each pair of neighbours to their distance."""
        return {(one, other): length for one, steps in self.steps.items() for other, _, length in steps}

    @cached_property
    def positions(self) -> dict[int, tuple[float, float]]:
        """Maps each node to its position. The position of a pin is that of its neighbour."""
        pitch = self.lanes - 1 + self.sizes.width + 2 * MARGIN
        found = {}
        for node in self.steps:
            column, row = self.at(node)
            gap, lane = divmod(column, self.lanes)
            found[node] = (float(gap * pitch + lane), float(row))
        return found

    @property
    def _useful_rows(self) -> list[int]:
        """Horizontal lines that wires can use: those that end at pins, those between rows of boxes, and the bar."""
        pins = {
            self._pin_rows[slot] + index
            for slot, count in self.sizes.pins.items()
            if slot in self._pin_rows
            for index in range(count)
        }
        boxes = {
            row
            for box in self.sizes.diagram.boxes
            for row in range(
                self.tops[box.block], self.tops[box.block] + self._row_heights[self.placement.cell_of[box.block][1]]
            )
        }
        return sorted((set(range(self.rows + 1)) - boxes) | pins)

    @property
    def _behind_boxes(self) -> set[tuple[int, int]]:
        """Pairs of (column of boxes, row) at which a box covers the horizontal line or is too close to it."""
        return {
            (self.placement.cell_of[box.block][0], row)
            for box in self.sizes.diagram.boxes
            for row in range(self.tops[box.block] - 1, self.tops[box.block] + self.sizes.height(box) + 2)
        }
