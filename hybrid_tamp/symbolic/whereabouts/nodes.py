"""Whereabouts of a token: its start, the ends of its possible movements, and the remaining unknown poses.

Blocks move a token from one node to another. `Block.ends` names the targets that decide where a token ends, and the
outcome of the block is the pose. A token that only moves up and down stays in its place (`Block.vertical`). Ends at the
same place, or at no place, with the same orientation are the same node. The exact position in such a node is unknown,
so only upper bounds of margins are valid there.
"""

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from hybrid_tamp.model.affordance import PlaceClass
from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.expectation import declared_end
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.predicate import Atom, Binding, Literal, SymbolSort, Value, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.symbolic.whereabouts.tracking import Tracking

MOST_NODES = 256
"""Largest number of nodes of one token. Further ends count as unknown poses."""
_SAME = math.cos(math.radians(0.5))
"""Scalar product of two unit quaternions whose orientations differ by 1 degree."""
_POSE = ("position", "orientation")

Row = tuple[str, ...]


class Whereabouts(PlaceClass):
    """The class of the nodes, which are places in the planning problem."""

    name: ClassVar[str] = "WHEREABOUTS"


@dataclass(frozen=True, eq=False)
class Node:
    """A set of poses of one token.

    Attributes:
        name: name of the node in the planning problem.
        token: name of the token.
        pose: maps properties of the token to representative values.
        place: name of the place that contains the token, or None.
        radius: largest horizontal distance from the representative position [m]. The distance can be infinite.
        oriented: whether the orientation is known.
    """

    name: str
    token: str
    pose: Mapping[str, FloatArray]
    place: str | None = None
    radius: float = 0.0
    oriented: bool = True

    def placed(self, state: State, names: Collection[str] = _POSE) -> State:
        """Return the state with the named properties of the token in its representative pose."""
        return state.replace({(self.token, name): value for name, value in self.pose.items() if name in names})

    def is_same(self, other: "Node") -> bool:
        """Return whether an end of a movement is this node."""
        if (self.place, self.oriented) != (other.place, other.oriented) or not self.radius:
            return False
        turned = self.oriented and "orientation" in self.pose
        return not turned or abs(float(self.pose["orientation"] @ other.pose["orientation"])) >= _SAME


@dataclass(frozen=True, eq=False)
class Nodes:
    """The nodes of all tokens that some block moves.

    Attributes:
        by_token: maps the name of each token to its nodes. The first node is the start of the token.
        rows: maps each pair of (block, slot) to its movements as rows of names: the token, the node before the
            movement, the values of the targets in `Block.ends`, and the node after the movement.
    """

    by_token: Mapping[str, tuple[Node, ...]]
    rows: Mapping[tuple[str, str], tuple[Row, ...]]


def find_nodes(task: Task, tracking: Tracking) -> Nodes:
    """Return the nodes of a task and the movements between the nodes."""
    rows: dict[tuple[str, str], list[Row]] = {
        (block, slot): [] for block, slots in tracking.moving_slots.items() for slot in slots
    }
    by_token = {
        token.name: tuple(_Explorer(task, token, rows).explore())
        for token in task.assigned
        if any(token.is_member(sort) for sort in _sorts(task, tracking))
    }
    return Nodes(by_token, {key: tuple(dict.fromkeys(found)) for key, found in rows.items()})


def _sorts(task: Task, tracking: Tracking) -> Iterator[type]:
    for block in task.domain.blocks:
        for role in tracking.roles(block):
            sort = block.roles[role]
            if not isinstance(sort, SymbolSort):
                yield sort


class _Explorer:
    """Explores the nodes of one token breadth-first."""

    def __init__(self, task: Task, token: Token, rows: Mapping[tuple[str, str], list[Row]]) -> None:
        self.task = task
        self.token = token
        self.rows = rows
        pose = {p: task.state[token, p].copy() for p in _POSE if (token.name, p) in task.state.layout.slices}
        start = Node(f"{token.name} at its start", token.name, pose)
        self.elsewhere = Node(f"{token.name} elsewhere", token.name, pose, None, math.inf, oriented=False)
        self.nodes = [start]
        self._margins: dict[tuple[str, Atom], float] = {}

    def explore(self) -> list[Node]:
        for node in self.nodes:  # The list grows during the loop.
            for (name, slot), found in self.rows.items():
                block = self.task.domain.block_by_name[name]
                if self.token.is_member(block.slot(slot).object_class):
                    for targets, end in self._ends(block, slot, node):
                        found.append((self.token.name, node.name, *map(name_of, targets), self._known(end).name))
        return self.nodes

    def _ends(self, block: Block, slot: str, node: Node) -> Iterator[tuple[tuple[Value, ...], Node]]:
        """Yield the values of the deciding targets and the end of each movement of the token in a slot."""
        if slot in block.vertical and node.oriented:
            raised = Node(f"{self.token.name} moved", self.token.name, node.pose, None, math.inf)
            yield (), raised if node.place is None else node
            return
        if slot not in block.ends or block.outcome is None:
            yield (), self.elsewhere
            return
        state = node.placed(self.task.state)
        for targets in self._targets(block, slot, node, state):
            binding = self._complete(block, slot, targets)
            if binding is not None:
                yield tuple(targets.values()), self._end(block, slot, node, targets, binding, state)

    def _targets(self, block: Block, slot: str, node: Node, state: State) -> Iterator[dict[str, Value]]:
        """Yield the values of the deciding targets that the symbolic entry conditions allow."""
        names = block.ends[slot]
        choices = {name: self.task.values_of(block.roles[name]) for name in names}
        relations = [c for c in block.static_entry if c.predicate.rows is not None and set(c.arguments) <= {*names}]
        symbolic = [c for c in block.entry if node.oriented and _is_symbolic(c, slot, names)]

        def holds(literal: Literal, bound: Binding) -> bool:
            atom = literal.ground({**bound, slot: self.token})
            if (node.name, atom) not in self._margins:
                self._margins[node.name, atom] = float(literal.margin(state, {**bound, slot: self.token}))
            return self._margins[node.name, atom] >= 0

        yield from enumerate_bindings(choices, [*relations, *symbolic], holds)

    def _complete(self, block: Block, slot: str, targets: Mapping[str, Value]) -> dict[str, Value] | None:
        """Return a binding of all roles, with any tokens in the other roles, or None if there are too few tokens."""
        choices = {
            role: (self.token,) if role == slot else (targets[role],) if role in targets else self.task.values_of(sort)
            for role, sort in block.roles.items()
        }
        return next(enumerate_bindings(choices), None)

    def _end(
        self, block: Block, slot: str, node: Node, targets: Mapping[str, Value], binding: Binding, state: State
    ) -> Node:
        after = declared_end(block, binding, state)
        assert after is not None, "a block with 'ends' declares its outcome"
        pose = {name: after[self.token, name].copy() for name in node.pose}
        place = next((v.name for v in targets.values() if isinstance(v, Token) and v.place), None)
        if place is None and not node.oriented:
            return self.elsewhere
        name = f"{self.token.name} " + (f"in {place}" if place else "moved")
        return Node(name, self.token.name, pose, place, _radius(block, slot, binding, after), node.oriented)

    def _known(self, end: Node) -> Node:
        """Return the node of an end, which is a new node if no other node is the same."""
        if end is not self.elsewhere and len(self.nodes) >= MOST_NODES:
            end = self.elsewhere
        same = next((node for node in self.nodes if node.is_same(end)), None)
        if same is not None:
            return same
        number = sum(node.name.startswith(end.name) for node in self.nodes)
        name = end.name if number == 0 else f"{end.name} {number + 1}"
        self.nodes.append(Node(name, end.token, end.pose, end.place, end.radius, end.oriented))
        return self.nodes[-1]


def _is_symbolic(literal: Literal, slot: str, targets: tuple[str, ...]) -> bool:
    """Return whether a condition assigns a symbol to the slot's token, e.g. a posture to a box."""
    predicate = literal.predicate
    if predicate.kind is not Kind.FUNCTIONAL or not set(literal.arguments) <= {slot, *targets}:
        return False
    return isinstance(predicate.parameters[predicate.functional_index or 0].sort, SymbolSort)


def _radius(block: Block, slot: str, binding: Binding, after: State) -> float:
    """Return how far the token may be from its expected end [m].

    If the block promises that the token is inside a place, the depth of the expected end is the largest distance.
    Otherwise, the distance is unknown.
    """
    for literal in block.exit:
        index = literal.predicate.functional_index
        if literal.positive and index is not None and literal.predicate.unit == "m" and slot in literal.arguments:
            value = binding.get(literal.arguments[index])
            if isinstance(value, Token) and value.place:
                return max(float(np.asarray(literal.margin(after, binding))), 0.0) or math.inf
    return math.inf
