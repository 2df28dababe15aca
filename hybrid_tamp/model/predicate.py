"""Predicates: signed margins with names; literals over roles; atoms over tokens.

A margin is zero or positive where the predicate holds. The one function serves the symbolic initial state, exit
tests during execution, the goal and the optimiser's constraint term, so that symbol and number cannot drift apart.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hybrid_tamp.errors import DomainError, Issue
from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.relation import Membership, order_rows, row_faults
from hybrid_tamp.model.stacking import stack
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

ANY = "*"
"""The wildcard of a negative literal: every value of that argument."""

Value = Token | str
"""What a predicate's argument is bound to: a token, or a symbol of a sort."""

Binding = Mapping[str, Value]
"""Role (slot or target) of an instance to the token or symbol bound to it."""


@dataclass(frozen=True)
class SymbolSort:
    """A finite closed set of symbols that conditions speak of, e.g. the faces of a box."""

    name: str
    symbols: tuple[str, ...]
    description: str = ""


@dataclass(frozen=True)
class Parameter:
    """One argument place of a predicate: its name and the class or sort that it ranges over."""

    name: str
    sort: type[ObjectClass] | SymbolSort


@dataclass(frozen=True, eq=False)
class Predicate:
    """A named signed margin over tokens and symbols.

    Attributes:
        name: name in task files, messages and PDDL.
        parameters: the argument places.
        margin: ``margin(state, *values)`` to an array ``(...)``, zero or positive where it holds.
        unit: unit of the margin.
        scale: size of a margin that counts as one unit of violation [unit].
        reads: parameter to the varying properties that the margin reads of it.
        kind: how its atoms come to hold, and how they cease to.
        value_of: of a functional predicate the parameter that has one value; None for others.
        rows: of a relation over symbols the arguments for which it holds, in the order of the sorts; None for others.
            `relation` sets them.
        by_name: whether the margin asks which tokens they are, not for their properties and states alone.
        share: of a load that several tokens bear together, ``share(state, *values)`` to what the first value has to
            bear and what it can bear [unit], for one state; the margin is their difference. None for other predicates.
        description: what it says, as a sentence over the parameters' names in braces,
            e.g. ``"{object} is within {region}"``.
        denial: what it says where it does not hold, e.g. ``"{object} is not within {region}"``.

    Raises:
        DomainError: the kind, `value_of` and `rows` contradict each other.
    """

    name: str
    parameters: tuple[Parameter, ...]
    margin: Callable[..., FloatArray]
    unit: str = "1"
    scale: float = 1.0
    reads: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    kind: Kind = Kind.CHANGING
    value_of: str | None = None
    description: str = ""
    denial: str = ""
    share: Callable[..., tuple[float, float]] | None = None
    rows: tuple[tuple[str, ...], ...] | None = None
    by_name: bool = False

    def __post_init__(self) -> None:
        faults = list(self._faults())
        if faults:
            raise DomainError(faults)

    @classmethod
    def relation(
        cls, name: str, parameters: tuple[Parameter, ...], rows: Iterable[tuple[str, ...]], **told: Any
    ) -> "Predicate":
        """Return the static predicate over symbols that holds for these rows and no others.

        Args:
            name: its name.
            parameters: its argument places, each over a symbol sort.
            rows: the arguments for which it holds.
            told: description and denial.

        Raises:
            DomainError: a row does not consist of symbols of these sorts.
        """
        ordered = order_rows(rows, list(map(_symbols, parameters)))
        margin = Membership(frozenset(ordered))
        return cls(name, parameters, margin, kind=Kind.STATIC, rows=ordered, **told)

    def _faults(self) -> Iterator[Issue]:
        names = tuple(parameter.name for parameter in self.parameters)
        if (self.kind is Kind.FUNCTIONAL) != (self.value_of is not None):
            yield Issue(self.name, "a functional predicate, and no other, says which parameter has one value")
        elif self.value_of is not None and self.value_of not in names:
            yield Issue(self.name, "value_of is a parameter of the predicate", repr(self.value_of), names)
        sorts = list(map(_symbols, self.parameters))
        over_symbols = all(isinstance(parameter.sort, SymbolSort) for parameter in self.parameters)
        if self.rows is None:
            if self.static and over_symbols:
                remedy = "make it with Predicate.relation"
                yield Issue(self.name, "a static predicate over symbols alone is declared by its rows", remedy=remedy)
            return
        if not (self.static and over_symbols):
            yield Issue(self.name, "a predicate with rows is static and over symbols alone")
            return
        yield from row_faults(self.name, self.rows, sorts)

    def __call__(self, *arguments: str) -> "Literal":
        """Return the positive literal over slots, targets, symbols or `ANY`."""
        return Literal(self, arguments)

    def __repr__(self) -> str:
        return f"Predicate({self.name!r})"

    @property
    def static(self) -> bool:
        """Whether it is decided once, before any search."""
        return self.kind is Kind.STATIC

    @property
    def maintained(self) -> bool:
        """Whether its atoms live as long as the instance that set them."""
        return self.kind is Kind.MAINTAINED

    @property
    def measured(self) -> bool:
        """Whether its initial facts are read off the continuous state at any time."""
        return self.kind in (Kind.CHANGING, Kind.FUNCTIONAL)

    @property
    def functional_index(self) -> int | None:
        """Index of the parameter that has one value, or None."""
        names = [parameter.name for parameter in self.parameters]
        return names.index(self.value_of) if self.value_of is not None else None

    def evaluate(self, state: State, *values: Value) -> FloatArray:
        """Return the margin ``(...)`` of the atom over the values."""
        return self.margin(state, *values)

    def margins(self, state: State, bindings: Sequence[tuple[Value, ...]]) -> FloatArray:
        """Return the margins ``(n, ...)`` of many bindings at once: of each what `evaluate` returns."""
        found = np.empty((len(bindings), *state.values.shape[:-1]))
        for each in stack(state, bindings, apart=self.by_name):
            found[each.places] = self.margin(each.state, *each.values)
        return found

    def sentence(self, names: tuple[str, ...], positive: bool = True) -> str:
        """Say the atom in words, e.g. ``drum is within goal``."""
        template = self.description if positive else self.denial
        if not template:
            return Atom(self.name, names, positive).text
        return template.format(**{p.name: n for p, n in zip(self.parameters, names, strict=True)})


def _symbols(parameter: Parameter) -> tuple[str, ...]:
    return parameter.sort.symbols if isinstance(parameter.sort, SymbolSort) else ()


@dataclass(frozen=True)
class Literal:
    """A signed predicate over a block's slots, targets and symbols; negative ones may have wildcards."""

    predicate: Predicate
    arguments: tuple[str, ...]
    positive: bool = True

    def __invert__(self) -> "Literal":
        return Literal(self.predicate, self.arguments, not self.positive)

    def __str__(self) -> str:
        return self.text

    @property
    def text(self) -> str:
        """The literal as text to print, e.g. ``not inside(object, region)``."""
        return f"{'' if self.positive else 'not '}{self.predicate.name}({', '.join(self.arguments)})"

    def ground(self, binding: Mapping[str, Value]) -> "Atom":
        """Replace roles by the names of what they are bound to; symbols and `ANY` stand for themselves."""
        return Atom(
            self.predicate.name,
            tuple(name_of(binding.get(argument, argument)) for argument in self.arguments),
            self.positive,
        )

    def margin(self, state: State, binding: Mapping[str, Value]) -> FloatArray:
        """Return the signed margin ``(...)``: of a negative literal the margin's negative."""
        values = [binding.get(argument, argument) for argument in self.arguments]
        margin = self.predicate.evaluate(state, *values)
        return margin if self.positive else -margin


@dataclass(frozen=True, order=True)
class Atom:
    """A ground literal by names: predicate, tokens or symbols, sign."""

    predicate: str
    arguments: tuple[str, ...]
    positive: bool = True

    def __str__(self) -> str:
        return self.text

    @property
    def text(self) -> str:
        """The atom as text to print, e.g. ``not inside(drum, goal)``."""
        return f"{'' if self.positive else 'not '}{self.predicate}({', '.join(self.arguments)})"

    def matches(self, other: "Atom") -> bool:
        """Say whether this pattern, which may hold wildcards, covers the other atom, signs aside."""
        return self.predicate == other.predicate and all(
            mine in (ANY, theirs) for mine, theirs in zip(self.arguments, other.arguments, strict=True)
        )


def name_of(value: Value) -> str:
    """Return the name of a token, or the symbol itself."""
    return value if isinstance(value, str) else value.name
