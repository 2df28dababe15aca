"""The columns of a drawing. A block stands to the right of the blocks from which tokens come to it."""

from collections.abc import Mapping

import networkx as nx

from hybrid_tamp.report.drawing.diagram import Diagram

_Sources = Mapping[str, Mapping[str, set[str]]]
"""Maps each block and each of its slots to the blocks from which tokens come."""


def find_columns(diagram: Diagram) -> dict[str, int]:
    """Map each block except the bar to its column, beginning at 0.

    An edge back to a block that a token must pass first, e.g. from ROLLING to the reach before it, has no influence.
    """
    sources = _sources(diagram)
    forth: _Sources = {
        block: {slot: (froms & _enterable(sources, diagram.bar.block, block)) for slot, froms in slots.items()}
        for block, slots in sources.items()
    }
    first = _earliest(forth, diagram.bar.block)
    graph: nx.DiGraph[str] = nx.DiGraph()
    graph.add_nodes_from(forth)
    graph.add_edges_from((one, b) for b in forth for froms in forth[b].values() for one in froms if one in forth)
    cycle = {block: number for number, group in enumerate(nx.strongly_connected_components(graph)) for block in group}
    back = [(one, b) for one, b in graph.edges if cycle[one] == cycle[b] and first[one] >= first[b]]
    graph.remove_edges_from(back)
    columns: dict[str, int] = {}
    for block in nx.lexicographical_topological_sort(graph):
        columns[block] = max((columns[one] + 1 for one in graph.predecessors(block)), default=0)
    return columns


def _sources(diagram: Diagram) -> _Sources:
    found = {box.block: {slot: set[str]() for slot in box.slots} for box in diagram.boxes}
    for wire in diagram.wires:
        for (one, _), (block, slot) in wire.edges:
            if block in found:
                found[block][slot].add(one)
    return found


def _enterable(sources: _Sources, bar: str, missing: str) -> set[str]:
    """Return the blocks that tokens from the bar can enter if one block is missing."""
    entered, size = {bar}, 0
    while len(entered) != size:
        size = len(entered)
        entered |= {b for b, slots in sources.items() if b != missing and all(s & entered for s in slots.values())}
    return entered


def _earliest(sources: _Sources, bar: str) -> dict[str, int]:
    """Map each block to the smallest number of blocks that its tokens pass before. The first of these is the bar."""
    found = {bar: 0} | dict.fromkeys(sources, len(sources))
    for _ in sources:
        for block, slots in sources.items():
            found[block] = max(min((found[one] + 1 for one in s), default=1) for s in slots.values())
    return found
