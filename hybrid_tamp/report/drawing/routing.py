"""The courses of wires along the lines of a lattice.

Each wire becomes a tree of short paths (A* search) that bend and cross other wires as seldom as possible. Wires never
share a line. A wire is routed around those before it, so wires are removed and routed again as long as this helps.
"""

import heapq
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import cache
from itertools import pairwise

import numpy as np

from hybrid_tamp.report.drawing.course import TAKEN, Course, End, count_crossings
from hybrid_tamp.report.drawing.lattice import HORIZONTAL, VERTICAL, Lattice
from hybrid_tamp.report.drawing.wires import Wire

_CROSSING, _BEND, _WRONG_SIDE, _BAR, _EDGE_PIN = 45.0, 4.0, 8.0, 6.0, 0.4
"""Costs in units of the grid: of a crossing, of a bend, of a pin on the side against the direction of the flow, of an
additional end at the bar, and of a pin beside the middle of its slot."""
_AT_BAR: End = (("", ""), True)
"""The end at the bar of a wire that also connects other slots."""
_OTHERS = 2
"""Number of other wires that are routed again together with a wire and those that it crosses."""
_FAR, _LEAST = float("inf"), 1e-6


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
        self._wires = sorted(wires, key=lambda wire: (len(wire.sources) + len(wire.targets), wire.edges), reverse=True)
        self.courses: dict[Wire, Course] = {}
        self._passed: dict[int, int] = {}
        self._lines: set[tuple[int, int]] = set()

    def route(self) -> None:
        """Route all wires twice, in the order of their numbers of ends, the largest first.

        Raises:
            NoCourse: a wire found no course.
        """
        for wire in self._wires * 2:
            self._renew([wire])

    def improve(self) -> None:
        """Route wires again together with the wires that they cross, as long as the cost decreases."""
        while any([self._try([wire, *self._crossed(wire)]) for wire in self._most_crossed()]):
            pass

    def shuffle(self, rng: np.random.Generator, attempts: int) -> None:
        """Route crossing wires and a few others again in random orders, and keep the courses that are not dearer."""
        for _ in range(attempts):
            crossed = [wire for wire in self._most_crossed() if self._crossed(wire)]
            if not crossed:
                return
            wire = crossed[int(rng.integers(len(crossed)))]
            others = [self._wires[int(index)] for index in rng.choice(len(self._wires), _OTHERS)]
            group = [*dict.fromkeys([wire, *self._crossed(wire), *others])]
            self._try([group[int(index)] for index in rng.permutation(len(group))], even=True)

    def _most_crossed(self) -> list[Wire]:
        return sorted(self._wires, key=lambda each: (-len(self._crossed(each)), each.edges))

    def _try(self, wires: Iterable[Wire], *, even: bool = False) -> bool:
        """Route wires again in the given order. Keep the new courses if they are cheaper, or if `even`, not dearer."""
        kept, cost = dict(self.courses), self.cost
        try:
            self._renew(wires)
            better = self.cost < cost - _LEAST
            keep = better or (even and self.cost < cost + _LEAST)
        except NoCourse:
            better = keep = False
        if not keep:
            self.courses = kept
        return better

    @property
    def crossings(self) -> int:
        """Number of points at which two wires cross."""
        return count_crossings(self.courses.values())

    @property
    def cost(self) -> float:
        """Total cost of the courses."""
        lengths = self.lattice.lengths
        lines = [line for course in self.courses.values() for line in course.lines]
        bends = sum(course.bends for course in self.courses.values())
        ends = sum(self.lattice.is_bar(node) for one, other, _ in lines for node in (one, other))
        length = sum(lengths[one, other] for one, other, _ in lines)
        wrong = sum(course.extra for course in self.courses.values())
        return length + wrong + _BEND * bends + _BAR * ends + _CROSSING * self.crossings

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
        ahead, passed, lines = self.lattice.ahead, self._passed, self._lines
        remaining = self._bounds_to(goals)
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
            # A wire cannot bend where it crosses another wire.
            for turned in (direction,) if node in passed else (direction, 1 - direction):
                for other, length in ahead[node, turned]:
                    state = passed.get(other)
                    if state in (TAKEN, turned) or (node, other) in lines:
                        continue
                    new = cost + length + _BEND * (turned != direction) + _CROSSING * (state is not None)
                    if new < best.get((other, turned), _FAR):
                        best[other, turned] = new
                        before[other, turned] = (node, direction)
                        heapq.heappush(heap, (new + remaining(other), new, other, turned))
        raise NoCourse

    def _bounds_to(self, goals: Collection[int]) -> Callable[[int], float]:
        """Return the function that gives a lower bound of the distance from a node to the nearest goal (A* search)."""
        positions = self.lattice.positions
        left, top, right, bottom = _bounds([positions[goal] for goal in goals])

        @cache
        def remaining(node: int) -> float:
            x, y = positions[node]
            return max(left - x, 0.0, x - right) + max(top - y, 0.0, y - bottom)

        return remaining


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
