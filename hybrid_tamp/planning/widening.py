"""Widening: which other objects are brought into a reduced network as tools, and in which order (paper, Sec. II-C).

"If the task cannot be accomplished with the reduced network, the network can be expanded by incorporating other
available objects as tools." The object that is nearest in the network comes first. Its distance is the number of edges
between the blocks that it makes fillable and the blocks in use: those of the reduced network and those that bring a
goal atom about. Ties are broken by the distance in space, then by name.
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
"""Number of nearest objects that are examined one by one: does this object alone bring the goal within reach?"""


class Widening:
    """The other available objects of a task, and what each of them is good for.

    Attributes:
        task: the task.
        reducer: reduces the task.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self.reducer = Reducer(task)

    @cached_property
    def all(self) -> Reduction:
        """The relevant network with all objects: it has a plan if the full network has one."""
        return self.reducer.reduce(self.task.token_by_name, find_relevant_blocks(self.task))

    def find_outside(self, reduction: Reduction) -> list[Token]:
        """Return the objects that were not brought in yet and fit a block of the network, in the task's order."""
        # Agents' tokens are always present, and join the network with the first block that they can fill.
        outside = self.all.tokens - reduction.tokens - self.reducer.capable - set(reduction.brought)
        return [token for token in self.task.assigned if token.name in outside]

    def choose_next(self, reduction: Reduction, most: int) -> list[str]:
        """Return the names of the objects to bring in next, in their order; an empty list if none is left.

        One object is enough if it brings the goal within reach, as far as can be told without planning. Otherwise these
        are the `most` nearest objects, or all if the goal stays out of reach even with all of them.
        """
        order = self._order_by_distance(reduction)
        for name in order[:MOST_EXAMINED]:
            if is_within_reach(self.reducer.reduce((*reduction.brought, name)).task):
                return [name]
        return order[:most] if len(order) <= most or is_within_reach(self.all.task) else order

    def _order_by_distance(self, reduction: Reduction) -> list[str]:
        """Return the names of the objects that can be brought in, the nearest first."""
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
        """Return the names of the blocks that an object makes fillable, sorted."""
        members = {above for member in self.task.token_by_name[name].classes for above in member.__mro__}
        roles = {block.name: block for each in members for block in self._asking.get(each, ())}
        roles |= {block.name: block for block in reduction.fillable}
        wider = self.reducer.reduce((*reduction.brought, name), roles.values())
        return tuple(sorted(wider.names - reduction.names))

    @cached_property
    def _asking(self) -> dict[type, list[Block]]:
        """Class of a slot or a target to the blocks that have one of this class."""
        found: dict[type, list[Block]] = {}
        for block in self.all.blocks:
            for sort in {sort for sort in block.roles.values() if not isinstance(sort, SymbolSort)}:
                found.setdefault(sort, []).append(block)
        return found

    def _distances(self, reduction: Reduction) -> Mapping[str, float]:
        """Return the number of edges from each block to the nearest block in use, on ways that avoid resting."""
        graph: nx.Graph[str] = nx.Graph()
        graph.add_nodes_from(self.all.names)
        edges = ((one, other) for (one, _), (other, _) in self.task.domain.network.graph.edges)
        graph.add_edges_from(edge for edge in edges if self.all.names.issuperset(edge))
        graph.remove_node(self.task.domain.resting)
        bringing = {block.name for atom in self.task.goal for block in find_achievers(self.task, self.all.blocks, atom)}
        used = set(graph.nbunch_iter(reduction.names | bringing))
        return dict(nx.multi_source_dijkstra_path_length(graph, used, weight=None)) if used else {}

    def _distance(self, name: str) -> float:
        """Return the distance of an object from the nearest token that the goal names [m]; 0 if one has no position."""
        state = self.task.state
        named = {each for atom in self.task.goal for each in atom.arguments}
        there = [state[each, "position"] for each in named if (each, "position") in state.layout.slices]
        if (name, "position") not in state.layout.slices or not there:
            return 0.0
        return min(float(np.linalg.norm(state[name, "position"] - place)) for place in there)


def find_achievers(task: Task, blocks: Iterable[Block], atom: Atom) -> Iterator[Block]:
    """Yield the blocks that bring an atom about, as far as classes and symbols tell."""
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
    """Return the goal atoms that do not hold and that no block brings about; what blocks need is ignored."""
    return [
        atom for atom in task.goal if task.margin(atom) < 0 and not any(find_achievers(task, task.domain.blocks, atom))
    ]


def is_within_reach(task: Task) -> bool:
    """Say whether the goal may be reached, as far as can be told without planning (see `backward_search`)."""
    if find_unreachable(task):
        return False
    search = BackwardSearch(task)
    try:
        return any(all(map(search.explore, each.goal)) for each in task.alternatives())
    except TooMany:
        return True
