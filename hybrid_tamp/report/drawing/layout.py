"""The positions of everything in a drawing, in points. The origin is the upper left corner, and y points downwards."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.network import SlotName
from hybrid_tamp.report.drawing.course import Course, count_crossings
from hybrid_tamp.report.drawing.diagram import Diagram
from hybrid_tamp.report.drawing.lattice import MARGIN, VERTICAL, Lattice
from hybrid_tamp.report.drawing.placement import place_boxes
from hybrid_tamp.report.drawing.routing import NoCourse, Router
from hybrid_tamp.report.drawing.sizes import GRID, Sizes
from hybrid_tamp.report.drawing.wires import Wire

Point = tuple[float, float]
_SEED, _PLACEMENTS = 0, 12
"""Seed of the searches, and number of placements for which wires are routed. The best drawing is kept."""
_IMPROVED, _ATTEMPTS = 4, 40
"""Number of the cheapest drawings that are improved, and number of attempts to route wires of the best of these again
in random orders."""
_LANES = 8
"""Number of vertical lines between two columns, unless the wires need more."""
BAR_HEIGHT = 6
"""Height of the bar, in units of the grid."""


@dataclass(frozen=True)
class Rectangle:
    """A rectangle [pt]."""

    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True)
class DrawnWire:
    """The lines of a wire.

    Attributes:
        wire: the wire.
        lines: straight horizontal or vertical lines that form a tree.
        ends: pairs of (slot, point at which the wire meets the slot, whether tokens enter the slot there).
    """

    wire: Wire
    lines: tuple[tuple[Point, Point], ...]
    ends: tuple[tuple[SlotName, Point, bool], ...]


@dataclass(frozen=True, eq=False)
class Layout:
    """The positions of everything in a drawing of a diagram.

    Attributes:
        diagram: the diagram.
        width: width of the drawing [pt].
        height: height of the drawing [pt].
        boxes: maps each block, also the bar, to its rectangle.
        slots: maps each slot to its rectangle.
        wires: the wires.
        crossings: number of points at which two wires cross.
    """

    diagram: Diagram
    width: float
    height: float
    boxes: Mapping[str, Rectangle]
    slots: Mapping[SlotName, Rectangle]
    wires: tuple[DrawnWire, ...]
    crossings: int


def lay_out(diagram: Diagram) -> Layout:
    """Return the layout with the fewest crossings that a search finds. Equal diagrams have equal layouts."""
    sizes = Sizes.of(diagram)
    placements, lanes = place_boxes(sizes, _SEED, _PLACEMENTS), _LANES
    while not (routers := [*_routers([Lattice(sizes, placement, lanes) for placement in placements])]):
        lanes *= 2
    best = sorted(routers, key=lambda router: router.cost)[:_IMPROVED]
    for router in best:
        router.improve()
    router = min(best, key=lambda router: (router.crossings, router.cost))
    router.shuffle(np.random.default_rng(_SEED), _ATTEMPTS)
    return _Positions(router.lattice, router.courses).layout()


def _routers(lattices: Iterable[Lattice]) -> Iterator[Router]:
    """Yield routers with courses for each lattice that has enough space for all wires."""
    for lattice in lattices:
        router = Router(lattice)
        try:
            router.route()
        except NoCourse:
            continue
        yield router


class _Positions:
    """Positions of the lines of a lattice, without the lines that no wire uses."""

    def __init__(self, lattice: Lattice, courses: Mapping[Wire, Course]) -> None:
        self._lattice, self._courses, self._sizes = lattice, courses, lattice.sizes
        lines = [(lattice.at(one), way) for course in courses.values() for one, _, way in course.lines]
        self._xs, self._lefts = self._columns({column for (column, _), way in lines if way == VERTICAL})
        self._ys = self._rows({row for (_, row), way in lines if way != VERTICAL})

    def _columns(self, used: set[int]) -> tuple[list[float], list[float]]:
        """Return the positions of the vertical lines, and of the left sides of the columns of boxes."""
        xs, lefts, x = list[float](), list[float](), 0.0
        last = self._lattice.placement.shape[0]
        for gap in range(last + 1):
            lanes = [gap * self._lattice.lanes + lane in used for lane in range(self._lattice.lanes)]
            present = any(lanes) or 0 < gap < last
            x += MARGIN * (present and gap > 0)
            xs += [x + sum(lanes[:lane]) for lane in range(len(lanes))]
            x += max(sum(lanes) - 1, 0) + MARGIN * (present and gap < last)
            lefts.append(x)
            x += self._sizes.width
        return xs, lefts

    def _rows(self, used: set[int]) -> list[float]:
        """Return the positions of the horizontal lines, also of the edge of the bar."""
        lattice, kept = self._lattice, set(used)
        for box in self._sizes.diagram.boxes:
            top = lattice.tops[box.block]
            kept |= set(range(top - 1, top + self._sizes.height(box) + 2))
        kept |= {lattice.rows - 1, lattice.rows - 2}
        ys, y = [], 0.0
        for row in range(lattice.rows + 1):
            ys.append(y)
            y += row in kept
        return ys

    def layout(self) -> Layout:
        """Return the layout."""
        lattice, sizes, diagram = self._lattice, self._sizes, self._sizes.diagram
        boxes, slots = dict[str, Rectangle](), dict[SlotName, Rectangle]()
        for box in diagram.boxes:
            x, top = self._lefts[lattice.placement.cell_of[box.block][0]], lattice.tops[box.block]
            boxes[box.block] = _rectangle(x, self._ys[top], sizes.width, sizes.height(box))
            for slot, below in sizes.tops(box, lattice.placement.order_of[box.block]).items():
                slots[slot] = _rectangle(x - 0.5, self._ys[top + below] - 0.5, sizes.width + 1, sizes.pins[slot])
        width, bottom = self._lefts[-1], self._ys[-1]
        boxes[diagram.bar.block] = _rectangle(-1, bottom, width + 2, BAR_HEIGHT)
        slots |= {slot: _rectangle(-1.5, bottom - 0.5, width + 3, 3) for slot in diagram.bar_slots}
        wires = tuple(self._draw(wire, course, slots) for wire, course in self._courses.items())
        height = (bottom + BAR_HEIGHT) * GRID
        return Layout(diagram, width * GRID, height, boxes, slots, wires, count_crossings(self._courses.values()))

    def _draw(self, wire: Wire, course: Course, slots: Mapping[SlotName, Rectangle]) -> DrawnWire:
        points, ends = dict[int, Point](), list[tuple[SlotName, Point, bool]]()
        pins = {node: end for end, node in course.pins.items()}
        bar = next(iter(self._lattice.sizes.diagram.bar_slots))
        for node in sorted({node for one, other, _ in course.lines for node in (one, other)}):
            column, row = self._lattice.at(node)
            x, y = self._xs[column] * GRID, self._ys[row] * GRID
            if node in pins:
                slot, into = pins[node]
                x = slots[slot].x + slots[slot].width * (self._lattice.side(node) > 0)
                ends.append((slot, (x, y), into or wire.both_ways))
            elif self._lattice.is_bar(node):
                y = slots[bar].y
                ends.append((bar, (x, y), bar in wire.targets or wire.both_ways))
            points[node] = x, y
        lines = tuple((points[one], points[other]) for one, other, _ in course.lines)
        return DrawnWire(wire, lines, tuple(ends))


def _rectangle(x: float, y: float, width: float, height: float) -> Rectangle:
    """Return a rectangle in points. The arguments are in units of the grid."""
    return Rectangle(x * GRID, y * GRID, width * GRID, height * GRID)
