"""Widening of a reduced network by other objects as tools, nearest objects first (paper, Sec. II-C).

"If the task cannot be accomplished with the reduced network, the network can be expanded by incorporating other
available objects as tools." The distance of an object is the smallest number of edges between a block that the object
makes fillable and a block in use. The blocks in use are the blocks of the reduced network and the blocks that achieve a
goal atom. Ties are broken by the distance in space, then by name.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property

import networkx as nx
import numpy as np

from hybrid_tamp.feasibility.backward_search import BackwardSearch
from hybrid_tamp.feasibility.bindings import TooMany
from hybrid_tamp.feasibility.relevance import find_relevant_blocks
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import ANY, Atom, Literal, SymbolSort
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.planning.reduction import Reducer, Reduction

MOST_EXAMINED = 16
"""Number of nearest objects that are tested separately. A test adds one object and checks if the goal is reachable."""


class Widening:
    """Selection of the objects to add to a reduced task.

    Attributes:
        task: the whole task.
        reducer: reducer of the task.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self.reducer = Reducer(task)

    @cached_property
    def all(self) -> Reduction:
        """The relevant network with all objects. This network has a plan if the full network has a plan."""
        return self.reducer.reduce(self.task.token_by_name, find_relevant_blocks(self.task))

    def find_outside(self, reduction: Reduction) -> list[Token]:
        """Return the objects outside the reduction that fit a block of the relevant network, in the task's order."""
        # Agents' tokens are excluded, because the reducer always considers them.
        outside = self.all.tokens - reduction.tokens - self.reducer.capable - set(reduction.brought)
        return [token for token in self.task.assigned if token.name in outside]

    def choose_next(self, reduction: Reduction, most: int) -> list[str]:
        """Return the names of the objects to add next, in order. The list is empty if no objects remain.

        If one of the nearest objects alone may make the goal reachable, return only this object. Otherwise return the
        `most` nearest objects. If the goal is unreachable even with all objects, return all objects.
        """
        order = self._order_by_distance(reduction)
        for name in order[:MOST_EXAMINED]:
            if is_within_reach(self.reducer.reduce((*reduction.brought, name)).task):
                return [name]
        return order[:most] if len(order) <= most or is_within_reach(self.all.task) else order

    def _order_by_distance(self, reduction: Reduction) -> list[str]:
        """Return the names of the objects that can be added, nearest objects first."""
        near = self._distances(reduction)
        kinds: dict[tuple[type, ...], float] = {}
        found = []
        for token in self.find_outside(reduction):
            if token.classes not in kinds:
                fillable = self.find_newly_fillable(reduction, token.name)
                kinds[token.classes] = min((near.get(block, math.inf) for block in fillable), default=math.inf)
            found.append((kinds[token.classes], self._distance(token.name), token.name))
        return [name for _, _, name in sorted(found)]

    def find_newly_fillable(self, reduction: Reduction, name: str) -> tuple[str, ...]:
        """Return the sorted names of the blocks that an object makes fillable."""
        members = {above for member in self.task.token_by_name[name].classes for above in member.__mro__}
        roles = {block.name: block for each in members for block in self._asking.get(each, ())}
        roles |= {block.name: block for block in reduction.fillable}
        wider = self.reducer.reduce((*reduction.brought, name), roles.values())
        return tuple(sorted(wider.names - reduction.names))

    @cached_property
    def _asking(self) -> dict[type, list[Block]]:
        """Maps each class to the blocks that have a slot or a target of this class."""
        found: dict[type, list[Block]] = {}
        for block in self.all.blocks:
            for sort in {sort for sort in block.roles.values() if not isinstance(sort, SymbolSort)}:
                found.setdefault(sort, []).append(block)
        return found

    def _distances(self, reduction: Reduction) -> Mapping[str, float]:
        """Return a dict that maps each block to its number of edges from the nearest block in use.

        Paths through the resting block are ignored.
        """
        graph: nx.Graph[str] = nx.Graph()
        graph.add_nodes_from(self.all.names)
        edges = ((one, other) for (one, _), (other, _) in self.task.domain.network.graph.edges)
        graph.add_edges_from(edge for edge in edges if self.all.names.issuperset(edge))
        graph.remove_node(self.task.domain.resting)
        bringing = {block.name for atom in self.task.goal for block in find_achievers(self.task, self.all.blocks, atom)}
        used = set(graph.nbunch_iter(reduction.names | bringing))
        return dict(nx.multi_source_dijkstra_path_length(graph, used, weight=None)) if used else {}

    def _distance(self, name: str) -> float:
        """Return the distance of an object from the nearest goal token in metres, or 0 if positions are missing."""
        state = self.task.state
        named = {each for atom in self.task.goal for each in atom.arguments}
        there = [state[each, "position"] for each in named if (each, "position") in state.layout.slices]
        if (name, "position") not in state.layout.slices or not there:
            return 0.0
        return min(float(np.linalg.norm(state[name, "position"] - place)) for place in there)


def find_achievers(task: Task, blocks: Iterable[Block], atom: Atom) -> Iterator[Block]:
    """Yield the blocks that may achieve an atom, judged by classes and symbols only."""
    for block in blocks:
        bringing = (each for each in block.exit if each.positive and each.predicate.name == atom.predicate)
        if any(_may_be(task, block, literal, atom) for literal in bringing):
            yield block


def _may_be(task: Task, block: Block, literal: Literal, atom: Atom) -> bool:
    for argument, name in zip(literal.arguments, atom.arguments, strict=True):
        sort, value = block.roles.get(argument), task.value(name)
        if name == ANY:
            fits = True
        elif sort is None or isinstance(sort, SymbolSort):
            fits = value in (sort.symbols if sort else (argument,))
        else:
            fits = isinstance(value, Token) and value.is_member(sort)
        if not fits:
            return False
    return True


def find_unreachable(task: Task) -> list[Atom]:
    """Return the goal atoms that do not hold and that no block achieves. Preconditions of blocks are ignored."""
    return [
        atom for atom in task.goal if task.margin(atom) < 0 and not any(find_achievers(task, task.domain.blocks, atom))
    ]


def is_within_reach(task: Task) -> bool:
    """Return whether the goal may be reachable according to the backward search (see `backward_search`)."""
    if find_unreachable(task):
        return False
    search = BackwardSearch(task)
    try:
        return any(all(map(search.explore, each.goal)) for each in task.alternatives())
    except TooMany:
        return True
