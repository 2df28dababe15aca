"""Predicates (named signed margins), literals over roles and atoms over tokens.

A predicate holds where its margin is zero or positive. The same margin gives the symbolic initial state, the exit tests
during execution, the goal and the optimiser's constraint term, so symbols and numbers always agree.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np

from hybrid_tamp.errors import DomainError, Issue
from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.relation import Membership, order_rows, row_faults
from hybrid_tamp.model.stacking import stack
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

ANY = "*"
"""The wildcard of a negative literal: it matches every value of that argument."""

Value = Token | str
"""Value of an argument of a predicate: a token, or a symbol of a sort."""

Binding = Mapping[str, Value]
"""Role (slot or target) of an instance to the token or symbol bound to it."""


class Kind(Enum):
    """The lifetime of the atoms of a predicate."""

    CHANGING = "changing"
    """Blocks set and delete its atoms."""
    FUNCTIONAL = "functional"
    """One parameter has at most one value for given other arguments, e.g. a place; a new value replaces the old one."""
    MAINTAINED = "maintained"
    """An atom holds only while the instance that set it runs."""
    STATIC = "static"
    """An atom is a feasibility fact: fixed properties and the initial state decide it once."""


@dataclass(frozen=True)
class SymbolSort:
    """A finite set of symbols that conditions use as arguments, e.g. the faces of a box."""

    name: str
    symbols: tuple[str, ...]
    description: str = ""


@dataclass(frozen=True)
class Parameter:
    """One parameter of a predicate: its name and the class or sort of its values."""

    name: str
    sort: type[ObjectClass] | SymbolSort


@dataclass(frozen=True, eq=False)
class Predicate:
    """A named signed margin over tokens and symbols.

    Attributes:
        name: name in task files, messages and PDDL.
        parameters: its parameters.
        margin: ``margin(state, *values)``, an array ``(...)`` that is zero or positive where it holds.
        unit: unit of the margin.
        scale: size of a margin that counts as one unit of violation [unit].
        reads: parameter to the varying properties of it that the margin reads.
        kind: the lifetime of its atoms.
        value_of: the parameter of a functional predicate that has one value; None for other kinds.
        rows: the arguments for which a relation over symbols holds, in the order of the sorts, set by `relation`;
            None for other predicates.
        by_name: whether the margin depends on the names of tokens, not only on their properties and states.
        share: for a load that several tokens bear together: ``share(state, *values)`` returns the load on the first
            value and its capacity [unit], for one state; the margin is their difference. None for other predicates.
        description: sentence with the parameters' names in braces, e.g. ``"{object} is within {region}"``.
        denial: sentence for a predicate that does not hold, e.g. ``"{object} is not within {region}"``.

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
            parameters: its parameters, each over a symbol sort.
            rows: the arguments for which it holds.
            **told: description and denial.

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
        elif not (self.static and over_symbols):
            yield Issue(self.name, "a predicate with rows is static and over symbols alone")
        else:
            yield from row_faults(self.name, self.rows, sorts)

    def __call__(self, *arguments: str) -> "Literal":
        """Return the positive literal over slots, targets, symbols or `ANY`."""
        return Literal(self, arguments)

    def __repr__(self) -> str:
        return f"Predicate({self.name!r})"

    @property
    def static(self) -> bool:
        """Whether its atoms are decided once, before any search."""
        return self.kind is Kind.STATIC

    @property
    def maintained(self) -> bool:
        """Whether its atoms hold only while the instance that set them runs."""
        return self.kind is Kind.MAINTAINED

    @property
    def measured(self) -> bool:
        """Whether its margin in a continuous state decides its atoms."""
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
        """Return the margins ``(n, ...)`` of n bindings, each as `evaluate` returns it."""
        found = np.empty((len(bindings), *state.values.shape[:-1]))
        for each in stack(state, bindings, apart=self.by_name):
            found[each.places] = self.margin(each.state, *each.values)
        return found

    def sentence(self, names: tuple[str, ...], positive: bool = True) -> str:
        """Return the atom as a sentence, e.g. ``drum is within goal``."""
        template = self.description if positive else self.denial
        if not template:
            return Atom(self.name, names, positive).text
        return template.format(**{p.name: n for p, n in zip(self.parameters, names, strict=True)})


def _symbols(parameter: Parameter) -> tuple[str, ...]:
    return parameter.sort.symbols if isinstance(parameter.sort, SymbolSort) else ()


@dataclass(frozen=True)
class Literal:
    """A signed predicate over a block's slots, targets and symbols; a negative literal may have wildcards."""

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
        """Return the atom with the bound names in place of roles; symbols and `ANY` stay."""
        names = tuple(name_of(binding.get(argument, argument)) for argument in self.arguments)
        return Atom(self.predicate.name, names, self.positive)

    def margin(self, state: State, binding: Mapping[str, Value]) -> FloatArray:
        """Return the signed margin ``(...)``; it is negated for a negative literal."""
        values = [binding.get(argument, argument) for argument in self.arguments]
        margin = self.predicate.evaluate(state, *values)
        return margin if self.positive else -margin


@dataclass(frozen=True, order=True)
class Atom:
    """A ground literal: names of the predicate and of its tokens or symbols, and the sign."""

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
        """Say whether this pattern, which may have wildcards, matches the other atom regardless of sign."""
        return self.predicate == other.predicate and all(
            mine in (ANY, theirs) for mine, theirs in zip(self.arguments, other.arguments, strict=True)
        )


def name_of(value: Value) -> str:
    """Return the name of a token, or the symbol itself."""
    return value if isinstance(value, str) else value.name
