"""The reassignment network, which defines the slots that a token can enter next (paper, Sec. II-C)."""

from collections.abc import Collection, Iterable
from itertools import product

import networkx as nx

from hybrid_tamp.model.plan import split_mode

SlotName = tuple[str, str]
"""Pair of (block, slot)."""


class ReassignmentNetwork:
    """A directed graph whose nodes are slots of blocks and whose edges are allowed reassignments."""

    def __init__(self, edges: Iterable[tuple[str, str]], blocks: Iterable[str] = ()) -> None:
        """Create the network from its edges.

        Args:
            edges: pairs of (source, target), each written ``"BLOCK.slot"``.
            blocks: names of the blocks. If an edge names an action without its mode, one edge for each mode is created.
        """
        modes: dict[str, list[str]] = {}
        for block in blocks:
            modes.setdefault(split_mode(block)[0], []).append(block)
        self.graph: nx.DiGraph[SlotName] = nx.DiGraph()
        for source, target in (map(parse_slot, edge) for edge in edges):
            for old, new in product(modes.get(source[0], [source[0]]), modes.get(target[0], [target[0]])):
                self.graph.add_edge((old, source[1]), (new, target[1]))

    def restrict(self, blocks: Collection[str]) -> "ReassignmentNetwork":
        """Return the part of the network that connects slots of the given blocks."""
        smaller = ReassignmentNetwork(())
        inside = ((one, other) for one in self.graph if one[0] in blocks for other in self.graph[one])
        smaller.graph.add_edges_from((one, other) for one, other in inside if other[0] in blocks)
        return smaller

    def extended(self, edges: Iterable[tuple[SlotName, SlotName]]) -> "ReassignmentNetwork":
        """Return a copy of the network with additional edges."""
        more = ReassignmentNetwork(())
        more.graph.add_edges_from((*self.edges, *edges))
        return more

    @property
    def edges(self) -> tuple[tuple[SlotName, SlotName], ...]:
        """All edges of the network, sorted."""
        return tuple(sorted(self.graph.edges))

    def allows(self, source: SlotName, target: SlotName) -> bool:
        """Return whether a token can pass from the source slot to the target slot."""
        return bool(self.graph.has_edge(source, target))

    def sources(self, slot: SlotName) -> tuple[SlotName, ...]:
        """Return the slots from which a token can pass to this slot, sorted."""
        return tuple(sorted(self.graph.predecessors(slot))) if slot in self.graph else ()

    def destinations(self, slot: SlotName) -> tuple[SlotName, ...]:
        """Return the slots to which a token can pass from this slot, sorted."""
        return tuple(sorted(self.graph.successors(slot))) if slot in self.graph else ()


def parse_slot(text: str) -> SlotName:
    """Return the block and the slot that a text ``"BLOCK.slot"`` names.

    Raises:
        ValueError: if the text has no dot, or if the block or the slot is empty.
    """
    block, dot, slot = text.rpartition(".")
    if not (block and dot and slot):
        raise ValueError(f"a slot must be written 'BLOCK.slot', got {text!r}")
    return (block, slot)


def slot_text(slot: SlotName) -> str:
    """Return a slot as text ``"BLOCK.slot"``."""
    return ".".join(slot)
