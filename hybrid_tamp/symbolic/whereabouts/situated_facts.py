"""Feasibility facts at the whereabouts of tokens."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

from hybrid_tamp.model.bindings import enumerate_bindings
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.facts import StaticFacts
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.margins import bound_margin
from hybrid_tamp.model.predicate import ANY, Literal, Predicate, SymbolSort, Value, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.symbolic.whereabouts.nodes import Node, Nodes, Row
from hybrid_tamp.symbolic.whereabouts.tracking import Tracking


@dataclass(frozen=True, eq=False)
class SituatedFacts:
    """The rows for which conditions hold, with one node per tracked token.

    Attributes:
        task: the task.
        tracking: conditions and slots that depend on whereabouts.
        nodes: nodes of the tokens.
        optimistic: whether a condition counts as true at a node unless an upper bound shows that it is false at every
            pose of the node. Otherwise, the condition is evaluated at the representative pose of the node.
    """

    task: Task
    tracking: Tracking
    nodes: Nodes
    optimistic: bool
    _known: dict[tuple[str | bool, ...], dict[Row, float]] = field(default_factory=dict)
    _holding: dict[tuple[str, ...], tuple[str, ...]] = field(default_factory=dict)

    def rows(self, block: Block, literal: Literal, roles: Sequence[str]) -> Iterator[Row]:
        """Yield the rows of names for which a condition of a block holds: its arguments, then the nodes of `roles`."""
        facts = StaticFacts(self.task)
        sorts = {role: block.roles[role] for role in literal.arguments if role in block.roles}
        relations = [
            each for each in block.static_entry if each.predicate.rows is not None and set(each.arguments) <= {*sorts}
        ]
        tracked = [[t for t in self.task.values_of(block.roles[role]) if isinstance(t, Token)] for role in roles]
        for tokens in product(*tracked):
            for nodes in product(*(self.nodes.by_token[token.name] for token in tokens)):
                state = self.task.state
                for node in nodes:
                    state = node.placed(state)
                choices = {role: self.task.values_of(sort) for role, sort in sorts.items()}
                choices |= {role: (token,) for role, token in zip(roles, tokens, strict=True)}
                choices |= self._symbols(block, dict(zip(roles, tokens, strict=True)), nodes, state)
                bound = enumerate_bindings(choices, relations, lambda each, values: facts.margin(each, values) >= 0)
                values = [tuple(binding.get(a, a) for a in literal.arguments) for binding in bound]
                known = self._known.setdefault((literal.predicate.name, literal.positive, *(n.name for n in nodes)), {})
                rows = {tuple(map(name_of, each)): each for each in values}
                new = [row for row in rows if row not in known]
                known |= dict(zip(new, self._margins(literal, nodes, [rows[row] for row in new]), strict=True))
                yield from ((*row, *(node.name for node in nodes)) for row in rows if known[row] >= 0)

    def _symbols(
        self, block: Block, tokens: Mapping[str, Token], nodes: Sequence[Node], state: State
    ) -> dict[str, tuple[Value, ...]]:
        """Return the symbols that the block requires of the tokens, e.g. the posture of a box, in these poses."""
        found: dict[str, tuple[Value, ...]] = {}
        for literal in block.entry:
            index = literal.predicate.functional_index
            if literal.predicate.kind is not Kind.FUNCTIONAL or index is None or ANY in literal.arguments:
                continue
            sort, symbol = literal.predicate.parameters[index].sort, literal.arguments[index]
            others = {argument for place, argument in enumerate(literal.arguments) if place != index}
            known = all(node.oriented for node in nodes) and others <= set(tokens)
            if isinstance(sort, SymbolSort) and symbol in block.roles and known:
                names = tuple(name_of(tokens.get(a, a)) for a in literal.arguments if a != symbol)
                key = (literal.predicate.name, *names, *(node.name for node in nodes))
                if key not in self._holding:
                    margins = (float(literal.margin(state, {**tokens, symbol: each})) for each in sort.symbols)
                    self._holding[key] = tuple(s for s, m in zip(sort.symbols, margins, strict=True) if m >= 0)
                found[symbol] = self._holding[key]
        return found

    def _margins(self, literal: Literal, nodes: Sequence[Node], values: Sequence[tuple[Value, ...]]) -> Sequence[float]:
        """Return the signed margin of a condition for each binding, or an upper bound if the pose is not known."""
        predicate = literal.predicate
        read = self._read(predicate, nodes)
        state = self.task.state
        for node in nodes:
            state = node.placed(state, read)
        radius = max((node.radius for node in nodes), default=0.0) if "position" in read else 0.0
        blind = bool(read - {"position", "orientation"})
        blind |= "orientation" in read and not all(node.oriented for node in nodes)
        if any(node.radius for node in nodes) and (self.optimistic or blind):
            if blind or (radius and (predicate.bound is None or not literal.positive)):
                return [0.0] * len(values)  # Nothing is known, so the condition may hold.
            if radius and predicate.bound is not None:
                return [bound_margin(predicate, state, radius, each) for each in values]
        margins = predicate.margins(state, values)
        return list(map(float, margins if literal.positive else -margins))

    def _read(self, predicate: Predicate, nodes: Sequence[Node]) -> set[str]:
        """Return the properties that the predicate reads from tokens that may have moved."""
        indices = self.tracking.parameters[predicate.name]
        moved = any(node.radius for node in nodes)
        return {p for i in indices for p in predicate.reads.get(predicate.parameters[i].name, ())} if moved else set()
