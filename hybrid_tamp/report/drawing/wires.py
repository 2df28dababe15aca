"""Edges of a reassignment network that are drawn as one wire.

A wire is a tree of lines. A token can pass from each source of the wire to each target. Parallel edges, e.g. those from
many slots to RESTING, therefore become one wire, and the wires together represent every edge exactly once.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations, product

from hybrid_tamp.model.network import SlotName

Edge = tuple[SlotName, SlotName]
_Node = tuple[SlotName, str]
"""A slot with its label. Slots with several labels are separate nodes, so that no wire mixes edges of two labels."""
_Nodes = frozenset[_Node]


@dataclass(frozen=True)
class Wire:
    """All edges from each source to each target.

    Attributes:
        sources: slots that tokens leave, sorted.
        targets: slots that tokens enter, sorted.
        both_ways: whether tokens can also pass from the target to the source. If so, there is one of each.
    """

    sources: tuple[SlotName, ...]
    targets: tuple[SlotName, ...]
    both_ways: bool

    @property
    def edges(self) -> tuple[Edge, ...]:
        """The edges of the network that the wire represents."""
        forth = tuple(product(self.sources, self.targets))
        return (*forth, *((target, source) for source, target in forth)) if self.both_ways else forth


def join_edges(edges: Iterable[Edge], label: Callable[[SlotName, SlotName], str]) -> tuple[Wire, ...]:
    """Return wires that together represent every edge exactly once, with few ends.

    In each step, the wire that saves the most ends is chosen. Finding the smallest number of ends is NP-hard.

    Args:
        edges: edges of a network.
        label: returns the label of the first slot as an end of an edge between both slots. A wire never joins edges
            whose ends at the same slot have different labels.
    """
    left = {((one, label(one, other)), (other, label(other, one))) for one, other in edges}
    wires = []
    while left:
        forth, mutual = _neighbours(left), _neighbours({edge for edge in left if edge[::-1] in left})
        found = [(group, False) for group in _groups(forth)]
        # With more than two ends, a line in both directions would seem to lead between two ends on the same side.
        found += [
            ((frozenset((one,)), frozenset((other,))), True) for one in mutual for other in mutual[one] if one < other
        ]
        (sources, targets), both_ways = min(found, key=_rank)
        chosen = set(product(sources, targets))
        left -= chosen | {edge[::-1] for edge in chosen if both_ways}
        wires.append(Wire(_slots(sources), _slots(targets), both_ways))
    return tuple(sorted(wires, key=lambda wire: (wire.sources, wire.targets)))


def _slots(nodes: _Nodes) -> tuple[SlotName, ...]:
    return tuple(sorted(slot for slot, _ in nodes))


def _neighbours(edges: Iterable[tuple[_Node, _Node]]) -> dict[_Node, _Nodes]:
    found: dict[_Node, set[_Node]] = {}
    for source, target in edges:
        found.setdefault(source, set()).add(target)
    return {source: frozenset(targets) for source, targets in found.items()}


def _groups(neighbours: Mapping[_Node, _Nodes]) -> Iterator[tuple[_Nodes, _Nodes]]:
    """Yield pairs of (sources, targets) in which an edge leads from each source to each target."""
    shared = {one & other for one, other in combinations(neighbours.values(), 2)} | {*neighbours.values()}
    single = {frozenset((target,)) for targets in neighbours.values() for target in targets}
    for targets in (shared | single) - {frozenset()}:
        yield frozenset(source for source, found in neighbours.items() if found >= targets), targets


def _rank(found: tuple[tuple[_Nodes, _Nodes], bool]) -> tuple[int, list[_Node], list[_Node]]:
    """Return a sort key. The best wire saves the most ends compared with one line per edge."""
    (sources, targets), both_ways = found
    edges = len(sources) * len(targets) * (1 + both_ways)
    return len(sources) + len(targets) - 2 * edges, sorted(sources), sorted(targets)
