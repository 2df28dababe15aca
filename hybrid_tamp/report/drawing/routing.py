"""The courses of wires along the lines of a lattice.

Each wire becomes a tree of short paths (A* search) that bend and cross other wires as seldom as possible. Wires never
share a line. A wire is routed around those before it, so wires are removed and routed again as long as this helps.
"""

import heapq
from collections.abc import Collection, Iterable, Mapping
from itertools import pairwise

from hybrid_tamp.report.drawing.course import TAKEN, Course, End, count_crossings
from hybrid_tamp.report.drawing.lattice import HORIZONTAL, VERTICAL, Lattice
from hybrid_tamp.report.drawing.wires import Wire

_CROSSING, _BEND, _WRONG_SIDE, _BAR, _EDGE_PIN = 45.0, 4.0, 8.0, 6.0, 0.4
"""Costs in units of the grid: of a crossing, of a bend, of a pin on the side against the direction of the flow, of an
additional end at the bar, and of a pin beside the middle of its slot."""
_AT_BAR: End = (("", ""), True)
"""The end at the bar of a wire that also connects other slots."""
_FAR = float("inf")


class NoCourse(Exception):
    """A wire found no course, because the space between the boxes is full."""


class Router:
    """Routes the wires of a diagram on a lattice.

    Attributes:
        lattice: the lattice.
        courses: maps each wire to its course.
    """

    def __init__(self, lattice: Lattice) -> None:
        self.lattice = lattice
        wires = lattice.sizes.diagram.wires
        self._wires = sorted(wires, key=lambda wire: (len(wire.sources) + len(wire.targets), wire.edges))
        self.courses: dict[Wire, Course] = {}
        self._passed: dict[int, int] = {}
        self._lines: set[tuple[int, int]] = set()

    def route(self, *, largest_first: bool) -> None:
        """Route all wires twice, in the order of their numbers of ends.

        Raises:
            NoCourse: a wire found no course.
        """
        for wire in (self._wires[::-1] if largest_first else self._wires) * 2:
            self._renew([wire])

    def improve(self) -> None:
        """Route wires again together with the wires that they cross, as long as the cost decreases."""
        cost, improved = self.cost, True
        while improved:
            improved = False
            for wire in sorted(self._wires, key=lambda each: (-len(self._crossed(each)), each.edges)):
                kept = dict(self.courses)
                try:
                    self._renew([wire, *self._crossed(wire)])
                except NoCourse:
                    self.courses = kept
                    continue
                new = self.cost
                if new < cost - 1e-6:
                    cost, improved = new, True
                else:
                    self.courses = kept

    @property
    def cost(self) -> float:
        """Total cost of the courses."""
        lengths = self.lattice.lengths
        lines = [line for course in self.courses.values() for line in course.lines]
        bends = sum(course.bends for course in self.courses.values())
        ends = sum(self.lattice.is_bar(node) for one, other, _ in lines for node in (one, other))
        length = sum(lengths[one, other] for one, other, _ in lines)
        wrong = sum(course.extra for course in self.courses.values())
        return length + wrong + _BEND * bends + _BAR * ends + _CROSSING * count_crossings(self.courses.values())

    def _crossed(self, wire: Wire) -> list[Wire]:
        mine = set(self.courses[wire].nodes)
        return [other for other in self._wires if other != wire and not mine.isdisjoint(self.courses[other].nodes)]

    def _renew(self, wires: Iterable[Wire]) -> None:
        """Remove the courses of some wires, and route these wires again in the given order."""
        wires = list(wires)
        for wire in wires:
            self.courses.pop(wire, None)
        for wire in wires:
            self._occupy()
            self.courses[wire] = self._grow(wire)

    def _occupy(self) -> None:
        """Find out which nodes and lines the present courses use."""
        self._passed, self._lines = {}, set()
        for course in self.courses.values():
            for node, state in course.nodes.items():
                self._passed[node] = TAKEN if node in self._passed else state
            self._lines |= {line for one, other, _ in course.lines for line in ((one, other), (other, one))}

    def _grow(self, wire: Wire) -> Course:
        """Return the course of a wire, which grows from one of its ends until it reaches all other ends."""
        slots, course = self.lattice.pins, Course()
        out = [(slot, False) for slot in wire.sources if slot in slots]
        into = [(slot, True) for slot in wire.targets if slot in slots]
        if not out or not into:  # each end may have its own line to the bar
            self._reach(wire, course, dict(self._bar), [*out, *into])
            return course
        start, *others = [*out, *into]
        if len(others) + 1 < len(wire.sources) + len(wire.targets):
            others.append(_AT_BAR)
        path, end = self._reach_next(wire, course, self._options(wire, start), others)
        course.pins[start] = path[0]
        course.extra += self._options(wire, start)[path[0]]
        self._reach(wire, course, self._free(path), [other for other in others if other != end])
        return course

    @property
    def _bar(self) -> dict[int, float]:
        return {node: _BAR for node in self.lattice.bar if node not in self._passed}

    def _free(self, path: list[int]) -> dict[int, float]:
        """Return the nodes of a path at which a line can branch off."""
        return {node: 0.0 for node in path[1:-1] if node not in self._passed}

    def _reach(self, wire: Wire, course: Course, tree: dict[int, float], ends: Iterable[End]) -> None:
        """Extend a course from the nodes of its tree to all given ends."""
        waiting = list(ends)
        while waiting:
            path, end = self._reach_next(wire, course, tree, waiting)
            waiting.remove(end)
            tree |= self._free(path)

    def _reach_next(
        self, wire: Wire, course: Course, tree: Mapping[int, float], ends: Iterable[End]
    ) -> tuple[list[int], End]:
        """Extend a course from a tree to the nearest of several ends. Return the new path and its end."""
        goals = {node: (end, cost) for end in ends for node, cost in self._options(wire, end).items()}
        path = self._search(tree, {node: extra for node, (_, extra) in goals.items()})
        end = goals[path[-1]][0]
        if end != _AT_BAR:
            course.pins[end] = path[-1]
        course.extra += goals[path[-1]][1] if end != _AT_BAR else 0.0
        course.lines += self._lines_of(path)
        return path, end

    def _options(self, wire: Wire, end: End) -> Mapping[int, float]:
        """Map each free node of an end to its cost."""
        if end == _AT_BAR:
            return self._bar
        slot, into = end
        nodes = self.lattice.pins[slot]
        middle, wanted = (len(nodes) // 2 - 1) / 2, -1 if into else 1
        # A token may also remain in a slot. Its wire leaves the slot on the right and comes back on the left.
        loop, either = slot in wire.sources and slot in wire.targets, wire.both_ways
        wrong = {node for node in nodes if self.lattice.side(node) != wanted}
        return {
            node: _EDGE_PIN * abs(index // 2 - middle) + _WRONG_SIDE * (node in wrong and not either)
            for index, node in enumerate(nodes)
            if node not in self._passed and not (loop and node in wrong)
        }

    def _lines_of(self, path: list[int]) -> list[tuple[int, int, int]]:
        found = []
        for one, other in pairwise(path):
            direction = next(d for node, d, _ in self.lattice.steps[one] if node == other)
            found.append((one, other, direction))
        return found

    def _search(self, starts: Mapping[int, float], goals: Mapping[int, float]) -> list[int]:
        """Return the cheapest path from a start to a goal. Values are the costs of starts and goals."""
        steps, passed, lines, positions = self.lattice.steps, self._passed, self._lines, self.lattice.positions
        left, top, right, bottom = _bounds([positions[goal] for goal in goals])

        def remaining(node: int) -> float:
            """Return a lower bound of the distance to a goal (A* search)."""
            x, y = positions[node]
            return max(left - x, 0.0, x - right) + max(top - y, 0.0, y - bottom)

        best = {(node, direction): cost for node, cost in starts.items() for direction in (HORIZONTAL, VERTICAL)}
        before: dict[tuple[int, int], tuple[int, int]] = {}
        heap = [(cost + remaining(state[0]), cost, *state) for state, cost in best.items()]
        heapq.heapify(heap)
        while heap:
            _, cost, node, direction = heapq.heappop(heap)
            if node < 0:
                return _path((-node - 1, direction), before)
            if cost > best[node, direction]:
                continue
            if node in goals:
                cost += goals[node]
                heapq.heappush(heap, (cost, cost, -node - 1, direction))
                continue
            for other, turned, length in steps[node]:
                state = passed.get(other)
                if (node, other) in lines or state in (TAKEN, turned) or (turned != direction and node in passed):
                    continue
                new = cost + length + _BEND * (turned != direction) + _CROSSING * (state is not None)
                if new < best.get((other, turned), _FAR):
                    best[other, turned] = new
                    before[other, turned] = (node, direction)
                    heapq.heappush(heap, (new + remaining(other), new, other, turned))
        raise NoCourse


def _bounds(positions: Collection[tuple[float, float]]) -> tuple[float, float, float, float]:
    """Return the smallest and the largest coordinates."""
    xs, ys = [x for x, _ in positions], [y for _, y in positions]
    return min(xs, default=0.0), min(ys, default=0.0), max(xs, default=0.0), max(ys, default=0.0)


def _path(state: tuple[int, int], before: Mapping[tuple[int, int], tuple[int, int]]) -> list[int]:
    path = [state[0]]
    while state in before:
        state = before[state]
        path.append(state[0])
    return path[::-1]
