"""Estimated costs of placements: length, direction and crossings of wires, wires behind boxes, and the page's shape.

A wire is estimated as straight lines from its ends to a hub between two columns.
"""

from itertools import combinations

import numpy as np
import numpy.typing as npt

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.report.drawing.sizes import Sizes

GUTTER, CHANNEL = 8, 4
"""Expected distances between columns and between rows, in units of the grid."""
_CROSSING, _HIT, _BACKWARDS, _SHAPE, _SWAPPED = 45.0, 12.0, 1.2, 60.0, 12.0
"""Costs of a crossing, of a line behind a box, of each unit to the left, of a page of another shape, and of a pair of
slots that is not in the order of the declaration."""
_ASPECT = 1.7
"""Wanted ratio of the width to the height of the page."""


class PlacementCost:
    """The costs of placements of one diagram. Lengths are in units of the grid."""

    def __init__(self, sizes: Sizes) -> None:
        self._sizes, diagram = sizes, sizes.diagram
        self._heights = np.array([sizes.height(box) for box in diagram.boxes])
        self._extents = np.stack([np.full(len(self._heights), sizes.width), self._heights], axis=1)
        slots = [(number, (box.block, slot)) for number, box in enumerate(diagram.boxes) for slot in box.slots]
        index = {slot: position for position, (_, slot) in enumerate(slots)}
        self._box_of = np.array([number for number, _ in slots])
        ends: list[tuple[int, int, bool]] = []
        self._drops: list[tuple[int, bool]] = []
        self._hub_drops: list[int] = []
        hubs = 0
        for wire in diagram.wires:
            sides = [[index[slot] for slot in side if slot in index] for side in (wire.sources, wire.targets)]
            if not all(sides):
                self._drops += [(slot, bool(sides[0])) for slot in (*sides[0], *sides[1])]
                continue
            ends += [(slot, hubs, out) for side, out in zip(sides, (True, False), strict=True) for slot in side]
            if sum(map(len, sides)) < len(wire.sources) + len(wire.targets):
                self._hub_drops.append(hubs)
            hubs += 1
        self._ends = np.array(ends, dtype=int).reshape(-1, 3)
        self._mean = np.zeros((hubs, len(ends)))
        self._mean[self._ends[:, 1], np.arange(len(ends))] = 1.0
        self._mean /= np.maximum(self._mean.sum(axis=1, keepdims=True), 1)
        self._known: dict[tuple[int, tuple[str, ...]], tuple[list[float], int]] = {}

    def of(self, cells: npt.NDArray[np.int64], orders: list[tuple[tuple[str, ...], ...]]) -> FloatArray:
        """Return the costs ``(b,)`` of placements with the given cells ``(b, n, 2)`` and orders of slots."""
        corners, page = self._corners(cells)
        ordered = [[self._ordered(*pair) for pair in enumerate(each)] for each in orders]
        middles = np.array([[middle for middles, _ in each for middle in middles] for each in ordered])
        swapped = np.array([sum(swaps for _, swaps in each) for each in ordered])
        lines, backwards = self._lines(corners, middles, page)
        length = np.abs(lines[:, :, 1] - lines[:, :, 0]).sum(axis=(1, 2))
        shape = _SHAPE * np.abs(np.log(page[:, 0] / page[:, 1] / _ASPECT)) + page.sum(axis=1) / 2
        crossed = _CROSSING * _crossings(lines) + _HIT * _hits(lines, corners, corners + self._extents)
        return np.asarray(length + backwards + crossed + shape + _SWAPPED * swapped)

    def _ordered(self, number: int, order: tuple[str, ...]) -> tuple[list[float], int]:
        """Return the distances of a box's slots from its top, and the number of pairs of swapped slots.

        The distances have the order of the declaration.
        """
        if (number, order) not in self._known:
            box, sizes = self._sizes.diagram.boxes[number], self._sizes
            tops = sizes.tops(box, order)
            middles = [tops[box.block, slot] + sizes.pins[box.block, slot] / 2 for slot in box.slots]
            swaps = sum(one > other for one, other in combinations(middles, 2))
            self._known[number, order] = (middles, swaps)
        return self._known[number, order]

    def _corners(self, cells: npt.NDArray[np.int64]) -> tuple[FloatArray, FloatArray]:
        """Return the upper left corners of the boxes ``(b, n, 2)`` and the sizes of the pages ``(b, 2)``."""
        used = cells[:, :, None, :] == np.arange(cells.max() + 1)[:, None]
        widths = np.where(used[..., 0].any(axis=1), self._sizes.width + GUTTER, 0)
        heights = np.where(used[..., 1], self._heights[:, None] + CHANNEL, 0).max(axis=1)
        ends = np.stack([widths, heights], axis=-1).cumsum(axis=1)
        starts = np.concatenate([np.zeros((len(cells), 1, 2)), ends], axis=1)
        return np.take_along_axis(starts, cells, axis=1), ends[:, -1].astype(float)

    def _lines(self, corners: FloatArray, middles: FloatArray, page: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the lines ``(b, l, 2, 2)``, and the cost of lines to the left ``(b,)``."""
        width, pitch = self._sizes.width, self._sizes.width + GUTTER
        left, y = corners[:, self._box_of, 0], corners[:, self._box_of, 1] + middles
        slots, hub_of, out = self._ends.T
        hub_x = (left[:, slots] + width / 2) @ self._mean.T
        hub_x = np.round((hub_x + GUTTER / 2) / pitch) * pitch - GUTTER / 2
        hub_y = y[:, slots] @ self._mean.T
        rightwards = hub_x[:, hub_of] > left[:, slots] + width / 2
        start = np.stack([left[:, slots] + np.where(rightwards, width, 0), y[:, slots]], axis=-1)
        hub = np.stack([hub_x, hub_y], axis=-1)
        behind = np.where(out, start[..., 0] - hub_x[:, hub_of], hub_x[:, hub_of] - start[..., 0])
        lines = [np.stack([start, hub[:, hub_of]], axis=2), *self._bar_lines(left, y, hub, page)]
        return np.concatenate(lines, axis=1), _BACKWARDS * np.maximum(behind + GUTTER / 2, 0).sum(axis=1)

    def _bar_lines(self, left: FloatArray, y: FloatArray, hub: FloatArray, page: FloatArray) -> list[FloatArray]:
        """Return the lines to the bar below the blocks, each ``(b, l, 2, 2)``."""
        found = []
        if self._drops:
            slots, out = np.array(self._drops).T
            x = left[:, slots] + np.where(out, self._sizes.width + GUTTER / 3, -GUTTER / 3)
            found.append(_to_bottom(np.stack([x, y[:, slots]], axis=-1), page))
        if self._hub_drops:
            found.append(_to_bottom(hub[:, self._hub_drops], page))
        return found


def _to_bottom(points: FloatArray, page: FloatArray) -> FloatArray:
    bottom = np.broadcast_to(page[:, None, 1], points.shape[:2])
    return np.stack([points, np.stack([points[..., 0], bottom], axis=-1)], axis=2)


def _crossings(lines: FloatArray) -> FloatArray:
    """Return how many pairs of lines ``(b, l, 2, 2)`` cross in each placement. Touching lines do not cross."""
    start, span = lines[:, :, 0], lines[:, :, 1] - lines[:, :, 0]
    gap, one, other = start[:, None] - start[:, :, None], span[:, :, None], span[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        det = one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]
        along_one = (gap[..., 0] * other[..., 1] - gap[..., 1] * other[..., 0]) / det
        along_other = (gap[..., 0] * one[..., 1] - gap[..., 1] * one[..., 0]) / det
        inside = (np.abs(along_one - 0.5) < 0.5 - 1e-6) & (np.abs(along_other - 0.5) < 0.5 - 1e-6)
    return np.asarray(inside.sum(axis=(1, 2)) / 2)


def _hits(lines: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Return how often lines pass behind boxes in each placement.

    Args:
        lines: starts and ends of the lines, shape ``(b, l, 2, 2)``.
        lower: upper left corners of the boxes, which have the smaller coordinates, shape ``(b, n, 2)``.
        upper: lower right corners of the boxes, shape ``(b, n, 2)``.
    """
    start, span = lines[:, :, None, 0], (lines[:, :, 1] - lines[:, :, 0])[:, :, None] + 1e-9
    low, high = (lower[:, None] + 1 - start) / span, (upper[:, None] - 1 - start) / span
    first, last = np.minimum(low, high).max(axis=-1), np.maximum(low, high).min(axis=-1)
    return np.asarray((np.maximum(first, 0) < np.minimum(last, 1)).sum(axis=(1, 2)).astype(float))
