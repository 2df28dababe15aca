"""The lines of a wire as strokes of a pen: paths between ends and junctions, and paths of tokens."""

from collections.abc import Iterator, Mapping
from itertools import pairwise

import networkx as nx

from hybrid_tamp.report.drawing.layout import DrawnWire, Point
from hybrid_tamp.report.drawing.wires import Edge

Stroke = tuple[Point, ...]
"""The corners of a line, with its start and its end."""


def strokes(wire: DrawnWire) -> Iterator[Stroke]:
    """Yield the line between each pair of neighbouring ends or junctions of a wire."""
    yield from (_corners(chain) for chain in _chains(_graph(wire)))


def token_strokes(wire: DrawnWire, passed: Mapping[Edge, tuple[str, ...]]) -> Iterator[tuple[Stroke, tuple[str, ...]]]:
    """Yield pairs of (stroke, names of the tokens that pass) for each stroke of a wire that tokens pass.

    Args:
        wire: the wire.
        passed: maps edges to the tokens that pass along the edge.
    """
    graph = _graph(wire)
    tokens: dict[frozenset[Point], list[str]] = {}
    for edge in wire.wire.edges:
        if edge in passed:
            path = _path(graph, wire, edge)
            for pair in pairwise(path):
                tokens.setdefault(frozenset(pair), []).extend(passed[edge])
    for chain in _chains(graph):
        if found := tokens.get(frozenset(chain[:2])):
            yield _corners(chain), tuple(sorted(set(found)))


def entered_ends(wire: DrawnWire, passed: Mapping[Edge, tuple[str, ...]]) -> dict[Point, tuple[str, ...]]:
    """Map each end through which tokens enter a slot to the names of these tokens."""
    graph = _graph(wire)
    found: dict[Point, set[str]] = {}
    for edge in wire.wire.edges:
        if edge in passed:
            found.setdefault(_path(graph, wire, edge)[-1], set()).update(passed[edge])
    return {end: tuple(sorted(tokens)) for end, tokens in found.items()}


def _chains(graph: "nx.Graph[Point]") -> Iterator[list[Point]]:
    """Yield the points of each line between two neighbouring ends or junctions."""
    stops = {point for point in graph if graph.degree[point] != 2}
    for stop in sorted(stops):
        for following in sorted(graph[stop]):
            path = [stop, following]
            while path[-1] not in stops:
                path.append(next(point for point in graph[path[-1]] if point != path[-2]))
            if path[0] <= path[-1]:
                yield path


def junctions(wire: DrawnWire) -> list[Point]:
    """Return the points at which more than two lines of a wire meet."""
    graph = _graph(wire)
    return sorted(point for point in graph if graph.degree[point] > 2)


def before(wire: DrawnWire, end: Point) -> Point:
    """Return the point of a wire that is connected to one of its ends."""
    (neighbour,) = _graph(wire)[end]
    return neighbour


def _path(graph: "nx.Graph[Point]", wire: DrawnWire, edge: Edge) -> list[Point]:
    """Return the points that a token passes along an edge of a wire."""
    both = wire.wire.both_ways
    begins = [point for slot, point, into in wire.ends if slot == edge[0] and (both or not into)]
    ends = [point for slot, point, into in wire.ends if slot == edge[1] and into]
    paths = [nx.shortest_path(graph, one, other) for one in begins for other in ends if nx.has_path(graph, one, other)]
    return min(paths, key=len)


def _graph(wire: DrawnWire) -> "nx.Graph[Point]":
    graph: nx.Graph[Point] = nx.Graph()
    graph.add_edges_from((one, other) for one, other in wire.lines if one != other)
    return graph


def _corners(path: list[Point]) -> Stroke:
    """Return a path without its points on straight lines."""
    inner = [
        point
        for before, point, after in zip(path, path[1:], path[2:], strict=False)
        if len({before[0], point[0], after[0]}) > 1 and len({before[1], point[1], after[1]}) > 1
    ]
    return (path[0], *inner, path[-1])
