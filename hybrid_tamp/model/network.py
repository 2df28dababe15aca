"""The reassignment network: which slot a token may go to next (paper, Sec. II-C)."""

from collections.abc import Iterable

import networkx as nx

SlotName = tuple[str, str]
"""(block, slot)."""


class ReassignmentNetwork:
    """Directed graph whose nodes are the slots of blocks and whose edges are allowed reassignments."""

    def __init__(self, edges: Iterable[tuple[str, str]]) -> None:
        """Make the network from pairs of ``"BLOCK.slot"`` names, source first."""
        self.graph: nx.DiGraph[SlotName] = nx.DiGraph()
        self.graph.add_edges_from((parse_slot(source), parse_slot(target)) for source, target in edges)

    @property
    def edges(self) -> tuple[tuple[SlotName, SlotName], ...]:
        """All edges, sorted."""
        return tuple(sorted(self.graph.edges))

    def allows(self, source: SlotName, target: SlotName) -> bool:
        """Say whether a token may pass from one slot to the other."""
        return bool(self.graph.has_edge(source, target))

    def sources(self, slot: SlotName) -> tuple[SlotName, ...]:
        """Slots from which a token may come into this one, sorted."""
        return tuple(sorted(self.graph.predecessors(slot))) if slot in self.graph else ()

    def destinations(self, slot: SlotName) -> tuple[SlotName, ...]:
        """Slots to which a token may go from this one, sorted."""
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
