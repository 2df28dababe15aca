"""The reassignment network: which slot a token may go to next (paper, Sec. II-C)."""

from collections.abc import Collection, Iterable
from itertools import product

import networkx as nx

from hybrid_tamp.model.plan import split_mode

SlotName = tuple[str, str]
"""(block, slot)."""


class ReassignmentNetwork:
    """Directed graph whose nodes are the slots of blocks and whose edges are allowed reassignments."""

    def __init__(self, edges: Iterable[tuple[str, str]], blocks: Iterable[str] = ()) -> None:
        """Make the network from pairs of ``"BLOCK.slot"`` names, source first.

        Args:
            edges: pairs of slots.
            blocks: names of blocks with modes, ``"ACTION:mode"``; an edge with the action alone holds for each mode.
        """
        modes: dict[str, list[str]] = {}
        for block in blocks:
            modes.setdefault(split_mode(block)[0], []).append(block)
        self.graph: nx.DiGraph[SlotName] = nx.DiGraph()
        for source, target in (map(parse_slot, edge) for edge in edges):
            for old, new in product(modes.get(source[0], [source[0]]), modes.get(target[0], [target[0]])):
                self.graph.add_edge((old, source[1]), (new, target[1]))

    def restrict(self, blocks: Collection[str]) -> "ReassignmentNetwork":
        """Return the network between slots of only these blocks."""
        smaller = ReassignmentNetwork(())
        inside = ((one, other) for one in self.graph if one[0] in blocks for other in self.graph[one])
        smaller.graph.add_edges_from((one, other) for one, other in inside if other[0] in blocks)
        return smaller

    def extended(self, edges: Iterable[tuple[SlotName, SlotName]]) -> "ReassignmentNetwork":
        """Return the network with more edges."""
        more = ReassignmentNetwork(())
        more.graph.add_edges_from((*self.edges, *edges))
        return more

    @property
    def edges(self) -> tuple[tuple[SlotName, SlotName], ...]:
        """All edges, sorted."""
        return tuple(sorted(self.graph.edges))

    def allows(self, source: SlotName, target: SlotName) -> bool:
        """Say whether a token may pass from one slot to the other."""
        return bool(self.graph.has_edge(source, target))

    def sources(self, slot: SlotName) -> tuple[SlotName, ...]:
        """Return the slots from which a token may pass to this one, sorted."""
        return tuple(sorted(self.graph.predecessors(slot))) if slot in self.graph else ()

    def destinations(self, slot: SlotName) -> tuple[SlotName, ...]:
        """Return the slots to which a token may pass from this one, sorted."""
        return tuple(sorted(self.graph.successors(slot))) if slot in self.graph else ()


def parse_slot(text: str) -> SlotName:
    """Split ``"BLOCK.slot"``.

    Raises:
        ValueError: there is no dot with a name on each side.
    """
    block, dot, slot = text.rpartition(".")
    if not (block and dot and slot):
        raise ValueError(f"a slot is written 'BLOCK.slot', got {text!r}")
    return (block, slot)


def slot_text(slot: SlotName) -> str:
    """Write a slot as ``"BLOCK.slot"``."""
    return ".".join(slot)
