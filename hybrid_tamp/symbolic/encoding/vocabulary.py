"""The words of a domain's PDDL: types, constants and predicates, by the user's names where there are any.

Classes: PDDL types inherit singly and affordances overlap, so a class becomes a type only where no token can be in
it and in another class that is neither above nor below it; otherwise it is a static unary predicate that guards the
slot. Either way it is found under its own name.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from hybrid_tamp.model.affordance import TOKEN, ObjectClass, is_place
from hybrid_tamp.model.block import Block, Target
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.predicate import Predicate, SymbolSort
from hybrid_tamp.model.token import Token
from hybrid_tamp.symbolic.pddl.naming import Naming, legal
from hybrid_tamp.symbolic.pddl.operators import Fact, Typed

COUNT = "how many"
NONE = "none reading"
ROOT = "object"


@dataclass(frozen=True, eq=False)
class Vocabulary:
    """Names and types that the compiled domain uses."""

    domain: Domain

    @cached_property
    def classes(self) -> tuple[type[ObjectClass], ...]:
        """All classes, the root class first."""
        return (TOKEN, *(c for c in self.domain.classes if c is not TOKEN))

    @cached_property
    def typed(self) -> tuple[type[ObjectClass], ...]:
        """Classes that are PDDL types."""
        return tuple(c for c in self.classes if c is TOKEN or not any(map(lambda d: self._crosses(c, d), self.classes)))

    def _crosses(self, one: type[ObjectClass], other: type[ObjectClass]) -> bool:
        nested = other is TOKEN or issubclass(one, other) or issubclass(other, one)
        return not nested and self.domain.relations.can_share_token(one, other)

    @cached_property
    def sorts(self) -> tuple[SymbolSort, ...]:
        """Symbol sorts of the domain, of predicates and of targets, each once."""
        mentioned = [*self.domain.sorts]
        mentioned += [p.sort for q in self.domain.predicates for p in q.parameters if isinstance(p.sort, SymbolSort)]
        mentioned += [t.sort for b in self.domain.blocks for t in b.targets if isinstance(t.sort, SymbolSort)]
        return tuple({sort.name: sort for sort in mentioned}.values())

    @cached_property
    def names(self) -> Naming:
        """PDDL names of the user's classes, sorts, symbols and predicates, and of the compiler's own words."""
        words = [c.name for c in self.classes] + [COUNT, NONE]
        words += [s.name for s in self.sorts] + [symbol for s in self.sorts for symbol in s.symbols]
        words += [p.name for p in self.domain.predicates]
        words += [no_value(p) for p in self.domain.predicates if p.functional]
        words += [opposite(p) for p in self.denied]
        return Naming(words, taken={name for name, _ in self.own_predicates})

    @cached_property
    def denied(self) -> tuple[Predicate, ...]:
        """Static predicates that some entry condition wants not to hold."""
        found = [c.predicate for b in self.domain.blocks for c in b.entry if c.predicate.static and not c.positive]
        return tuple({predicate.name: predicate for predicate in found}.values())

    @cached_property
    def own_predicates(self) -> tuple[tuple[str, tuple[Typed, ...]], ...]:
        """The compiler's predicates over assignment; their names never depend on the user's tokens."""
        return tuple(_assignment_predicates(self.domain))

    def word(self, name: str) -> str:
        """Return the PDDL name of a class, sort, symbol or predicate."""
        return self.names.pddl(name)

    def type_of(self, sort: type[ObjectClass] | SymbolSort) -> str:
        """Return the PDDL type of variables that range over a class or sort."""
        if isinstance(sort, SymbolSort) or sort in self.typed:
            return self.word(sort.name)
        above = [c for c in sort.__mro__ if c in self.typed]
        return self.word(above[0].name) if above else (ROOT if is_place(sort) else self.word(TOKEN.name))

    def narrower(
        self, one: type[ObjectClass] | SymbolSort, other: type[ObjectClass] | SymbolSort
    ) -> type[ObjectClass] | SymbolSort:
        """Return the one of two classes of a token whose PDDL type lies below the other's, else the first."""
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
        """Yield the unary fact that guards a variable whose class is no type."""
        if not isinstance(sort, SymbolSort) and sort not in self.typed:
            yield (self.word(sort.name), variable)

    @property
    def types(self) -> tuple[Typed, ...]:
        """(type, parent) pairs."""
        pairs = [(self.word(c.name), self._parent(c)) for c in self.typed]
        pairs += [(self.word(s.name), ROOT) for s in self.sorts]
        return (*pairs, (self.word(COUNT), ROOT))

    def _parent(self, object_class: type[ObjectClass]) -> str:
        above = [c for c in object_class.__mro__[1:] if c in self.typed]
        if above:
            return self.word(above[0].name)
        return ROOT if object_class is TOKEN or is_place(object_class) else self.word(TOKEN.name)

    def token_type(self, token: Token) -> str:
        """Return the PDDL type of a token: the deepest class that it is a member of and that is a type."""
        deepest = max(filter(token.is_member, self.typed), key=lambda c: (len(c.__mro__), c is not TOKEN), default=None)
        return self.word(deepest.name) if deepest else ROOT

    @property
    def constants(self) -> tuple[Typed, ...]:
        """Symbols, the value 'none' of each functional predicate, and the count zero."""
        symbols = [(self.word(symbol), self.word(s.name)) for s in self.sorts for symbol in s.symbols]
        values = []
        for predicate in self.domain.predicates:
            if predicate.functional_index is not None:
                sort = predicate.parameters[predicate.functional_index].sort
                values.append((self.word(no_value(predicate)), self.type_of(sort)))
        return (*symbols, *values, (self.word(NONE), self.word(COUNT)))

    @property
    def predicates(self) -> tuple[tuple[str, tuple[Typed, ...]], ...]:
        """Every predicate with its typed parameters."""
        root, count = self.word(TOKEN.name), self.word(COUNT)
        guards = [
            (self.word(c.name), (("?thing", ROOT if is_place(c) else root),))
            for c in self.classes
            if c not in self.typed
        ]
        named = [(p.name, p) for p in self.domain.predicates] + [(opposite(p), p) for p in self.denied]
        users = [
            (self.word(name), tuple((f"?{legal(q.name)}", self.type_of(q.sort)) for q in p.parameters))
            for name, p in named
        ]
        kinds = {"TOKEN": root, "COUNT": count, "OBJECT": ROOT}
        own = [(name, tuple((v, kinds.get(t, t)) for v, t in parameters)) for name, parameters in self.own_predicates]
        own = [(name, tuple((v, self._role_type(t)) for v, t in parameters)) for name, parameters in own]
        return (*guards, *users, *own)

    def _role_type(self, kind: str) -> str:
        block, dot, role = kind.partition("/")
        return self.type_of(self.domain.block_by_name[block].roles[role]) if dot else kind


def no_value(predicate: Predicate) -> str:
    """Return the name of the symbol that says that a functional predicate has no value."""
    return f"no {predicate.functional} of {predicate.name}"


def opposite(predicate: Predicate) -> str:
    """Return the name of the static predicate that says that this one does not hold."""
    return f"not {predicate.name}"


def locked_targets(domain: Domain, block: Block) -> tuple[Target, ...]:
    """Return the targets of a block that some block's system may change while this block reads them."""

    def written(target: Target) -> bool:
        return any(
            set(block.writes.get(slot.name, ())) & set(target.reads)
            and not isinstance(target.sort, SymbolSort)
            and domain.relations.can_share_token(slot.object_class, target.sort)
            for block in domain.blocks
            for slot in block.slots
        )

    return tuple(target for target in block.targets if written(target))


def remembered(domain: Domain, block: Block, slot: str) -> tuple[str, ...]:
    """Return the targets that must be known when the token in a slot leaves.

    The anchor remembers locked targets, to release them; every slot those of its maintained exit conditions.
    """
    locked = {t.name for t in locked_targets(domain, block)} if slot == block.anchor else set()
    targets = {t.name for t in block.targets}
    for literal in block.exit:
        if literal.predicate.maintained and literal.positive and keeper(block, literal.arguments) == slot:
            locked |= targets & set(literal.arguments)
    return tuple(t.name for t in block.targets if t.name in locked)


def keeper(block: Block, arguments: tuple[str, ...]) -> str:
    """Return the slot whose token carries a condition: the last slot in it besides the anchor, else the anchor."""
    others = [slot.name for slot in block.others if slot.name in arguments]
    return others[-1] if others else block.anchor


def _assignment_predicates(domain: Domain) -> Iterator[tuple[str, tuple[Typed, ...]]]:
    yield ("idle", ())
    for name in ("settled", "unclaimed", "completed"):
        yield (name, (("?token", "TOKEN"),))
    yield ("readers", (("?token", "TOKEN"), ("?count", "COUNT")))
    yield ("next", (("?count", "COUNT"), ("?more", "COUNT")))
    yield ("distinct", (("?one", "OBJECT"), ("?other", "OBJECT")))
    for block in domain.blocks:
        name = legal(block.name)
        anchor = ("?anchor", f"{block.name}/{block.anchor}")
        yield (
            f"in-{name}",
            (anchor, *((f"?{legal(t)}", f"{block.name}/{t}") for t in remembered(domain, block, block.anchor))),
        )
        for slot in block.others:
            yield (
                f"in-{name}-{legal(slot.name)}",
                (
                    ("?token", f"{block.name}/{slot.name}"),
                    anchor,
                    *((f"?{legal(t)}", f"{block.name}/{t}") for t in remembered(domain, block, slot.name)),
                ),
            )
            for state in ("claimed", "full", "moved"):
                yield (f"{state}-{name}-{legal(slot.name)}", (anchor,))
        for target in block.targets if block.others else ():
            yield (f"for-{name}-{legal(target.name)}", (anchor, ("?target", f"{block.name}/{target.name}")))
        for rest in remainders(block):
            yield (leaving(block, rest), (anchor,))


def remainders(block: Block) -> tuple[tuple[str, ...], ...]:
    """Return every non-empty set of slots, in order, that may still have to leave after the anchor has."""
    names = [slot.name for slot in block.others]
    sets: list[tuple[str, ...]] = [()]
    for name in names:
        sets += [(*chosen, name) for chosen in sets]
    return tuple(chosen for chosen in sets if chosen)


def leaving(block: Block, rest: tuple[str, ...]) -> str:
    """Return the predicate that says that the tokens of these slots are still to leave."""
    return "-".join(["leaving", legal(block.name), *map(legal, rest)])
