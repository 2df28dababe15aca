"""The PDDL types, constants and predicates of a domain, with names similar to the user's names.

A PDDL type has one parent, but affordance classes overlap. So a class becomes a type only if every class that may share
its tokens is one of its superclasses or subclasses. Every other class becomes a static unary predicate, which guards
the variables of the class.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from hybrid_tamp.model.affordance import TOKEN, ObjectClass, is_place
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import Predicate, SymbolSort
from hybrid_tamp.model.token import Token
from hybrid_tamp.symbolic.encoding.assignment import COUNT, ROOT, Sort, State, assignment_predicates
from hybrid_tamp.symbolic.pddl.naming import Naming, legal, name_apart, name_variables
from hybrid_tamp.symbolic.pddl.operators import Fact, Typed

Word = tuple[str, str]
"""Pair of (kind, user's name) of a named thing. The kind is class, sort, symbol, predicate, ..."""

_NONE_READING: Word = ("count", "none reading")


@dataclass(frozen=True, eq=False)
class Vocabulary:
    """The PDDL names and types of a compiled domain."""

    domain: Domain

    @cached_property
    def classes(self) -> tuple[type[ObjectClass], ...]:
        """All classes of the domain, with the root class first."""
        return (TOKEN, *(c for c in self.domain.classes if c is not TOKEN))

    @cached_property
    def typed(self) -> tuple[type[ObjectClass], ...]:
        """The classes that are PDDL types."""
        return tuple(c for c in self.classes if c is TOKEN or not any(map(lambda d: self._crosses(c, d), self.classes)))

    def _crosses(self, one: type[ObjectClass], other: type[ObjectClass]) -> bool:
        nested = other is TOKEN or issubclass(one, other) or issubclass(other, one)
        return not nested and self.domain.relations.can_share_token(one, other)

    @cached_property
    def sorts(self) -> tuple[SymbolSort, ...]:
        """The symbol sorts of the domain, of its predicates and of its targets, without duplicates."""
        mentioned = [*self.domain.sorts]
        mentioned += [p.sort for q in self.domain.predicates for p in q.parameters if isinstance(p.sort, SymbolSort)]
        mentioned += [t.sort for b in self.domain.blocks for t in b.targets if isinstance(t.sort, SymbolSort)]
        return tuple({sort.name: sort for sort in mentioned}.values())

    @cached_property
    def names(self) -> Naming[Word]:
        """The PDDL names of the user's classes, sorts, symbols and predicates, and of the compiler's constants."""
        words: dict[Word, str] = {("class", c.name): c.name for c in self.classes}
        words |= {("sort", s.name): s.name for s in self.sorts}
        words |= {("symbol", symbol): symbol for s in self.sorts for symbol in s.symbols}
        words |= {("predicate", p.name): p.name for p in self.domain.predicates}
        words |= {("no value", p.name): f"no {p.value_of} of {p.name}" for p in self.domain.predicates if p.value_of}
        words |= {("opposite", p.name): f"not {p.name}" for p in self.denied}
        words |= {("type", COUNT): COUNT, _NONE_READING: _NONE_READING[1]}
        return Naming(words, taken=self._state_names.values())

    @cached_property
    def denied(self) -> tuple[Predicate, ...]:
        """The static predicates that some entry condition negates."""
        found = [c.predicate for b in self.domain.blocks for c in b.static_entry if not c.positive]
        return tuple({predicate.name: predicate for predicate in found}.values())

    # -- words ----------------------------------------------------------------------------------------------------

    def symbol(self, name: str) -> str:
        """Return the PDDL constant of a symbol."""
        return self.names.pddl(("symbol", name))

    def predicate(self, name: str, positive: bool = True) -> str:
        """Return the PDDL name of a predicate, or of the predicate that stands for its negation."""
        return self.names.pddl(("predicate" if positive else "opposite", name))

    def no_value(self, predicate: Predicate) -> str:
        """Return the constant 'none' of a functional predicate, which means that the predicate has no value."""
        return self.names.pddl(("no value", predicate.name))

    @property
    def none_reading(self) -> str:
        """The constant that stands for zero readers."""
        return self.names.pddl(_NONE_READING)

    def state(self, kind: str, block: Block, *names: str) -> str:
        """Return the PDDL name of the compiler predicate about a block and some of its slots or targets."""
        state = (kind, block.name, *names)
        return self._state_names[state]

    @cached_property
    def _state_names(self) -> Mapping[State, str]:
        # These names depend on the domain only, never on tokens.
        return name_apart({state: "-".join(map(legal, state)) for state, _ in assignment_predicates(self.domain)})

    # -- types ----------------------------------------------------------------------------------------------------

    def type_of(self, sort: Sort) -> str:
        """Return the PDDL type of the variables of a class, a sort, `COUNT` or `ROOT`."""
        if isinstance(sort, str):
            return ROOT if sort == ROOT else self.names.pddl(("type", sort))
        if isinstance(sort, SymbolSort):
            return self.names.pddl(("sort", sort.name))
        if sort in self.typed:
            return self.names.pddl(("class", sort.name))
        above = [c for c in sort.__mro__ if c in self.typed]
        return self.type_of(above[0] if above else ROOT if is_place(sort) else TOKEN)

    def narrower(
        self, one: type[ObjectClass] | SymbolSort, other: type[ObjectClass] | SymbolSort
    ) -> type[ObjectClass] | SymbolSort:
        """Return the class with the narrower PDDL type, or the first class if neither type contains the other."""
        if isinstance(one, SymbolSort) or isinstance(other, SymbolSort):
            return one
        below = dict(self.types)
        parent: str | None = self.type_of(other)
        while parent is not None:
            if parent == self.type_of(one):
                return other
            parent = below.get(parent)
        return one

    def guard(self, variable: str, sort: type[ObjectClass] | SymbolSort) -> Iterator[Fact]:
        """Yield the fact that a variable is a member of its class, if the class is not a PDDL type."""
        if not isinstance(sort, SymbolSort) and sort not in self.typed:
            yield (self.names.pddl(("class", sort.name)), variable)

    @property
    def types(self) -> tuple[Typed, ...]:
        """The PDDL types as pairs of (type, parent)."""
        pairs = [(self.type_of(c), self._parent(c)) for c in self.typed]
        pairs += [(self.type_of(s), ROOT) for s in self.sorts]
        return (*pairs, (self.type_of(COUNT), ROOT))

    def _parent(self, object_class: type[ObjectClass]) -> str:
        above = [c for c in object_class.__mro__[1:] if c in self.typed]
        if above:
            return self.type_of(above[0])
        return ROOT if object_class is TOKEN or is_place(object_class) else self.type_of(TOKEN)

    def token_type(self, token: Token) -> str:
        """Return the narrowest PDDL type of a token."""
        deepest = max(filter(token.is_member, self.typed), key=lambda c: (len(c.__mro__), c is not TOKEN), default=None)
        return self.type_of(deepest) if deepest else ROOT

    # -- declarations ---------------------------------------------------------------------------------------------

    @property
    def constants(self) -> tuple[Typed, ...]:
        """The symbols, the value 'none' of each functional predicate, and the number zero, with their types."""
        symbols = [(self.symbol(symbol), self.type_of(s)) for s in self.sorts for symbol in s.symbols]
        values = [
            (self.no_value(predicate), self.type_of(predicate.parameters[predicate.functional_index].sort))
            for predicate in self.domain.predicates
            if predicate.functional_index is not None
        ]
        return (*symbols, *values, (self.none_reading, self.type_of(COUNT)))

    @property
    def predicates(self) -> tuple[tuple[str, tuple[Typed, ...]], ...]:
        """The user's predicates and the predicates that stand for classes, with typed parameters."""
        guards = [
            self._declare(self.names.pddl(("class", c.name)), [("thing", ROOT if is_place(c) else TOKEN)])
            for c in self.classes
            if c not in self.typed
        ]
        users = [(self.predicate(p.name), p) for p in self.domain.predicates]
        users += [(self.predicate(p.name, positive=False), p) for p in self.denied]
        return (*guards, *(self._declare(name, [(q.name, q.sort) for q in p.parameters]) for name, p in users))

    @property
    def assignment_predicates(self) -> tuple[tuple[str, tuple[Typed, ...]], ...]:
        """The compiler predicates, with typed parameters."""
        declared = assignment_predicates(self.domain)
        return tuple(self._declare(self._state_names[state], parameters) for state, parameters in declared)

    def _declare(self, name: str, parameters: Sequence[tuple[str, Sort]]) -> tuple[str, tuple[Typed, ...]]:
        variables = name_variables(parameter for parameter, _ in parameters)
        return name, tuple((v, self.type_of(sort)) for v, (_, sort) in zip(variables, parameters, strict=True))
