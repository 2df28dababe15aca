"""The course of a wire along the lines of a lattice."""

from collections.abc import Collection
from dataclasses import dataclass, field

from hybrid_tamp.model.network import SlotName

End = tuple[SlotName, bool]
"""An end of a wire: a slot, and whether tokens enter this slot."""
TAKEN = 2
"""State of a node at which a wire bends, branches or ends, so that no other wire may cross."""


@dataclass
class Course:
    """The course of a wire.

    Attributes:
        lines: lines to neighbouring nodes, as triples of (node, node, direction).
        pins: maps each end at a slot, as a pair of (slot, whether it is a target), to its node.
        extra: sum of the costs of the pins.
    """

    lines: list[tuple[int, int, int]] = field(default_factory=list)
    pins: dict[End, int] = field(default_factory=dict)
    extra: float = 0.0

    @property
    def bends(self) -> int:
        """Number of nodes at which horizontal and vertical lines meet."""
        return len({node for node, d in self._directions.items() if len(set(d)) > 1})

    @property
    def nodes(self) -> dict[int, int]:
        """Maps each node to the direction in which the wire passes straight through, or to ``TAKEN``."""
        return {node: d[0] if len(d) == 2 and d[0] == d[1] else TAKEN for node, d in self._directions.items()}

    @property
    def _directions(self) -> dict[int, list[int]]:
        directions: dict[int, list[int]] = {}
        for one, other, direction in self.lines:
            directions.setdefault(one, []).append(direction)
            directions.setdefault(other, []).append(direction)
        return directions


def count_crossings(courses: Collection[Course]) -> int:
    """Return at how many nodes two wires cross."""
    passed = [node for course in courses for node in course.nodes]
    return len(passed) - len(set(passed))
