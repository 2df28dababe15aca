"""Predicates as named signed margins, literals over roles, and atoms over tokens.

A predicate holds if its margin is zero or positive. The same margin defines the symbolic initial state, the exit tests
during execution, the goal and the optimiser's constraint term. So symbolic and continuous states always agree.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from hybrid_tamp.errors import DomainError, Issue
from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.disc import Disc
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.margins import SafetyFactor, evaluate_margin
from hybrid_tamp.model.relation import Membership, order_rows, row_faults
from hybrid_tamp.model.stacking import stack
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

ANY = "*"
"""Wildcard argument. In a negative literal, the wildcard matches every value."""
Value = Token | str
"""Value of a predicate's argument: a token or a symbol."""
Binding = Mapping[str, Value]
"""Maps each role (slot or target) of an instance to its token or symbol."""


@dataclass(frozen=True)
class SymbolSort:
    """A finite set of symbols that conditions use as arguments, e.g. the faces of a box."""

    name: str
    symbols: tuple[str, ...]
    description: str = ""


@dataclass(frozen=True)
class Parameter:
    """A parameter of a predicate, with its name and the class or sort of its values."""

    name: str
    sort: type[ObjectClass] | SymbolSort


@dataclass(frozen=True, eq=False)
class Predicate:
    """A named signed margin over tokens and symbols.

    Attributes:
        name: name of the predicate in task files, messages and PDDL.
        parameters: parameters of the predicate.
        margin: function ``margin(state, *values)`` that returns the margin, shape ``(...)``. If the predicate has a
            safety factor, `margin`, `share` and `bound` get the factor as the keyword argument ``factor``.
        unit: unit of the margin.
        scale: divisor that makes violations dimensionless [unit]. A margin of ``-scale`` is a violation of 1.
        reads: maps each parameter to the varying properties that the margin reads from the parameter's token.
        kind: kind of the predicate.
        value_of: name of the parameter that has at most one value. None unless the predicate is functional.
        rows: tuples of symbols for which a relation holds (see `relation`), in the order of the sorts. Otherwise None.
        by_name: whether the margin or the rows depend on names of tokens, not only on properties and states.
        share: function ``share(state, *values)`` for a load that several tokens bear together. The function returns a
            pair of (load, capacity) for the first token [unit]. None for other predicates.
        safety: safety factor of a static predicate, or None.
        competence: whether a static predicate describes a limit of the blocks, not of physics. Messages mention this.
        at_start: whether the predicate by definition describes the initial state, so that no block changes its atoms.
        bound: function ``bound(state, radius, *values)`` that returns an upper bound of the margin over all horizontal
            displacements of the tokens by at most `radius` [m]. The radius can be infinite.
        confines: function ``confines(state, *values)`` that returns the `Disc` that must contain the first token.
        distance: function ``distance(state, *values)`` that returns the distance from the desired state [unit], >= 0.
        detail: function ``detail(state, *values)`` that says why a static predicate does not hold, with names and
            figures. None if the margin alone says enough.
        description: sentence with parameters in braces, e.g. ``"{object} is within {region}"``.
        denial: sentence for a predicate that does not hold, e.g. ``"{object} is not within {region}"``.

    Raises:
        DomainError: if `kind`, `value_of` and `rows` contradict each other.
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
    safety: SafetyFactor | None = None
    competence: bool = False
    at_start: bool = False
    bound: Callable[..., FloatArray] | None = None
    confines: Callable[..., Disc] | None = None
    distance: Callable[..., FloatArray] | None = None
    detail: Callable[..., str] | None = None

    def __post_init__(self) -> None:
        faults = list(self._faults())
        if faults:
            raise DomainError(faults)

    @classmethod
    def relation(
        cls, name: str, parameters: tuple[Parameter, ...], rows: Iterable[tuple[str, ...]], **told: Any
    ) -> "Predicate":
        """Return a static predicate that holds only for the given rows of symbols.

        Args:
            name: name of the predicate.
            parameters: parameters of the predicate, each with a symbol sort.
            rows: arguments for which the predicate holds.
            **told: `description` and `denial` of the predicate.

        Raises:
            DomainError: if a row does not have one symbol of each parameter's sort.
        """
        ordered = order_rows(rows, list(map(_symbols, parameters)))
        return cls(name, parameters, Membership(frozenset(ordered)), kind=Kind.STATIC, rows=ordered, **told)

    def _faults(self) -> Iterator[Issue]:
        names = tuple(parameter.name for parameter in self.parameters)
        if (self.kind is Kind.FUNCTIONAL) != (self.value_of is not None):
            yield Issue(self.name, "'value_of' must be set if the predicate is functional, and must be None otherwise")
        elif self.value_of is not None and self.value_of not in names:
            yield Issue(self.name, "'value_of' must be a parameter of the predicate", repr(self.value_of), names)
        over_symbols = all(isinstance(parameter.sort, SymbolSort) for parameter in self.parameters)
        if self.rows is not None:
            lawful = self.static and (over_symbols or self.by_name)
            yield from row_faults(self.name, self.rows, list(map(_symbols, self.parameters)), lawful)
        elif self.static and over_symbols:
            remedy = "create the predicate with Predicate.relation"
            yield Issue(self.name, "a static predicate with only symbol parameters must have rows", remedy=remedy)

    def __call__(self, *arguments: str) -> "Literal":
        """Return a positive literal. Each argument is a slot, a target, a symbol or `ANY`."""
        return Literal(self, arguments)

    def __repr__(self) -> str:
        return f"Predicate({self.name!r})"

    @property
    def static(self) -> bool:
        """Whether the atoms of the predicate are feasibility facts, which are computed once before the search."""
        return self.kind is Kind.STATIC

    @property
    def maintained(self) -> bool:
        """Whether an atom of the predicate is added by an instance and holds only until this instance ends."""
        return self.kind is Kind.MAINTAINED

    @property
    def measured(self) -> bool:
        """Whether the margin in the current continuous state determines the truth of an atom."""
        return self.kind in (Kind.CHANGING, Kind.FUNCTIONAL)

    @property
    def functional_index(self) -> int | None:
        """Index of the parameter that has at most one value, or None if the predicate is not functional."""
        names = [parameter.name for parameter in self.parameters]
        return names.index(self.value_of) if self.value_of is not None else None

    @cached_property
    def keywords(self) -> dict[str, float]:
        """Keyword arguments of `margin`, `share` and `bound`: the safety factor, or none without a safety factor."""
        return {} if self.safety is None else {"factor": self.safety.factor}

    def evaluate(self, state: State, *values: Value) -> FloatArray:
        """Return the margin for the given arguments, shape ``(...)``. Margins within a rounding error of 0 are 0."""
        return evaluate_margin(self, state, values)

    def margins(self, state: State, bindings: Sequence[tuple[Value, ...]]) -> FloatArray:
        """Return the margins for n tuples of arguments, shape ``(n, ...)``."""
        found = np.empty((len(bindings), *state.values.shape[:-1]))
        for each in stack(state, bindings, apart=self.by_name):
            found[each.places] = self.evaluate(each.state, *each.values)
        return found

    def sentence(self, names: tuple[str, ...], positive: bool = True) -> str:
        """Return a sentence which says that an atom holds or does not hold, e.g. ``drum is within goal``."""
        template = self.description if positive else self.denial
        if not template:
            return Atom(self.name, names, positive).text
        return template.format(**{p.name: n for p, n in zip(self.parameters, names, strict=True)})


def _symbols(parameter: Parameter) -> tuple[str, ...]:
    return parameter.sort.symbols if isinstance(parameter.sort, SymbolSort) else ()


@dataclass(frozen=True)
class Literal:
    """A predicate or a negated predicate with roles and symbols as arguments. A negative literal can have wildcards."""

    predicate: Predicate
    arguments: tuple[str, ...]
    positive: bool = True

    def __invert__(self) -> "Literal":
        return Literal(self.predicate, self.arguments, not self.positive)

    def __str__(self) -> str:
        return self.text

    @property
    def text(self) -> str:
        """Literal as text, e.g. ``not inside(object, region)``."""
        return f"{'' if self.positive else 'not '}{self.predicate.name}({', '.join(self.arguments)})"

    def ground(self, binding: Mapping[str, Value]) -> "Atom":
        """Return the atom in which each role is replaced by the name of its token, or by its symbol."""
        names = tuple(name_of(binding.get(argument, argument)) for argument in self.arguments)
        return Atom(self.predicate.name, names, self.positive)

    def margin(self, state: State, binding: Mapping[str, Value]) -> FloatArray:
        """Return the signed margin, shape ``(...)``. For a negative literal, the margin of the predicate is negated."""
        margin = self.predicate.evaluate(state, *[binding.get(argument, argument) for argument in self.arguments])
        return margin if self.positive else -margin


@dataclass(frozen=True, order=True)
class Atom:
    """A ground literal, which refers to the predicate, the tokens and the symbols by name."""

    predicate: str
    arguments: tuple[str, ...]
    positive: bool = True

    def __str__(self) -> str:
        return self.text

    @property
    def text(self) -> str:
        """Atom as text, e.g. ``not inside(drum, goal)``."""
        return f"{'' if self.positive else 'not '}{self.predicate}({', '.join(self.arguments)})"

    def matches(self, other: "Atom") -> bool:
        """Return whether this atom matches the other atom. Only this atom can have wildcards. Signs are ignored."""
        return self.predicate == other.predicate and all(
            mine in (ANY, theirs) for mine, theirs in zip(self.arguments, other.arguments, strict=True)
        )


def name_of(value: Value) -> str:
    """Return the name of a token, or the symbol unchanged."""
    return value if isinstance(value, str) else value.name
