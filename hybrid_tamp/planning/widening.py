"""Widening: which further objects are brought into a reduced network as tools, and in which order (paper, Sec. II-C).

"If the task cannot be accomplished with the reduced network, the network can be expanded by incorporating other
available objects as tools." Nearest in the network comes first: by the edges between the blocks that an object makes
fillable and those in use, which are the blocks of the reduced network and those that bring a goal atom about; then
nearest in space; then by name.
"""

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from functools import cached_property

import networkx as nx
import numpy as np

from hybrid_tamp.feasibility.backward_search import Backwards
from hybrid_tamp.feasibility.bindings import TooMany
from hybrid_tamp.feasibility.relevance import relevant_blocks
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.predicate import ANY, Atom, Literal, SymbolSort
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.planning.reduction import Reducer, Reduction

LOOKED_AT = 16
"""So many of the nearest objects are looked at one by one, whether with one of them the goal comes within reach."""


class Widening:
    """The other available objects of a task, and what each of them is good for.

    Attributes:
        task: the task.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self._reducer = Reducer(task)

    def reduce(self, brought: Collection[str] = ()) -> Reduction:
        """Return the task reduced, with objects brought in."""
        return self._reducer.reduce(brought)

    @cached_property
    def all(self) -> Reduction:
        """The relevant network with every object brought in: it has a plan if the full network has one."""
        return self._reducer.reduce(self.task.token_by_name, relevant_blocks(self.task))

    def find_outside(self, reduction: Reduction, brought: Collection[str]) -> list[Token]:
        """Return the objects that were not brought in yet and fit somewhere in the network, in the task's order."""
        # Agents' tokens are always there, and come in with the first block that they can fill.
        inside = reduction.tokens | self._reducer.capable | set(brought)
        outside = self.all.tokens - inside
        return [token for token in self.task.assigned if token.name in outside]

    def choose_next(self, reduction: Reduction, brought: Collection[str], most: int) -> list[str]:
        """Return the names of the objects to bring in next, in their order; none are left if there are none.

        One is enough if the goal comes within reach with it, as far as can be told without planning. Else it is the
        nearest ones: `most` of them, or all if even with all of them the goal stays out of reach.
        """
        order = self.order_by_distance(reduction, brought)
        for name in order[:LOOKED_AT]:
            if is_within_reach(self.reduce((*brought, name)).task):
                return [name]
        return order[:most] if len(order) <= most or is_within_reach(self.all.task) else order

    def order_by_distance(self, reduction: Reduction, brought: Collection[str]) -> list[str]:
        """Return the names of the objects that are left out and fit somewhere, the nearest first."""
        near = self._distances(reduction)
        kinds: dict[tuple[type, ...], float] = {}
        for token in self.find_outside(reduction, brought):
            if token.classes not in kinds:
                fillable = self.newly_fillable(reduction, brought, token.name)
                kinds[token.classes] = min((near.get(block, math.inf) for block in fillable), default=math.inf)
        found = [
            (kinds[token.classes], self._distance(token.name), token.name)
            for token in self.find_outside(reduction, brought)
        ]
        return [name for _, _, name in sorted(found)]

    def newly_fillable(self, reduction: Reduction, brought: Collection[str], name: str) -> tuple[str, ...]:
        """Return the names of the blocks that an object makes fillable, sorted."""
        members = {above for member in self.task.token_by_name[name].classes for above in member.__mro__}
        roles = {block.name: block for each in members for block in self._asking.get(each, ())}
        roles |= {block.name: block for block in reduction.fillable}
        wider = self._reducer.reduce((*brought, name), roles.values())
        return tuple(sorted(wider.names - reduction.names))

    @cached_property
    def _asking(self) -> dict[type, list[Block]]:
        """The blocks that ask for a class, in a slot or a target."""
        found: dict[type, list[Block]] = {}
        for block in self.all.blocks:
            for sort in set(block.roles.values()):
                if not isinstance(sort, SymbolSort):
                    found.setdefault(sort, []).append(block)
        return found

    def _distances(self, reduction: Reduction) -> Mapping[str, float]:
        """Return how many edges each block of the network is from the nearest in use; not by way of resting."""
        graph: nx.Graph[str] = nx.Graph()
        graph.add_nodes_from(self.all.names)
        edges = ((one, other) for (one, _), (other, _) in self.task.domain.network.graph.edges)
        graph.add_edges_from(edge for edge in edges if self.all.names.issuperset(edge))
        graph.remove_node(self.task.domain.resting)
        bringing = {block.name for atom in self.task.goal for block in find_achievers(self.task, self.all.blocks, atom)}
        used = set(graph.nbunch_iter(reduction.names | bringing))
        return dict(nx.multi_source_dijkstra_path_length(graph, used, weight=None)) if used else {}

    def _distance(self, name: str) -> float:
        """Return how far [m] an object is from the nearest token that the goal names; 0 where that cannot be said."""
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
    """Return the goal atoms that do not hold and that no block brings about: a glance, without a look further back."""
    return [
        atom for atom in task.goal if task.margin(atom) < 0 and not any(find_achievers(task, task.domain.blocks, atom))
    ]


def is_within_reach(task: Task) -> bool:
    """Say whether the goal may be reached as far as can be told without planning (see `backwards`)."""
    if find_unreachable(task):
        return False
    search = Backwards(task)
    try:
        return any(all(map(search.explore, each.goal)) for each in task.alternatives())
    except TooMany:
        return True
