"""The edges of a diagram for languages whose programs find the layout."""

from dataclasses import dataclass

from hybrid_tamp.model.network import SlotName
from hybrid_tamp.report.drawing.diagram import Diagram
from hybrid_tamp.report.drawing.palette import wire_colour


@dataclass(frozen=True)
class Link:
    """An edge, or two edges in both directions.

    Attributes:
        source: slot that tokens leave.
        target: slot that tokens enter.
        both_ways: whether tokens can also pass from the target to the source.
        colour: colour of the line.
        tokens: names of the tokens whose marked paths contain the edge.
    """

    source: SlotName
    target: SlotName
    both_ways: bool
    colour: str
    tokens: tuple[str, ...]


def links_of(diagram: Diagram) -> tuple[Link, ...]:
    """Return the links of a diagram, sorted. They represent every edge exactly once."""
    edges = {edge: wire for wire in diagram.wires for edge in wire.edges}
    found = []
    for source, target in sorted(edges):
        opposite = (target, source) in edges and source != target
        if opposite and target < source:
            continue
        passing = [*diagram.passed.get((source, target), ()), *diagram.passed.get((target, source), ())]
        colour = wire_colour(diagram, edges[source, target])
        found.append(Link(source, target, opposite, colour, tuple(dict.fromkeys(passing))))
    return tuple(found)
