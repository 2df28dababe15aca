"""Predicates: signed margins with names; literals over roles; atoms over tokens.

A margin is zero or positive where the predicate holds. The one function serves the symbolic initial state, exit
tests during execution, the goal and the optimiser's constraint term, so that symbol and number cannot drift apart.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from hybrid_tamp.model.affordance import ObjectClass
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
        static: decided once from fixed properties and the initial state; a feasibility fact.
        functional: a parameter that has at most one value for given other arguments (a place, a posture);
            setting a value replaces the old one.
        maintained: its atoms live only as long as the block instance whose exit set them: they are held by
            that block's hold and void once its tokens leave.
        denial: what is wrong where it does not hold, as a sentence like ``description``; else that it is not so.
        share: of a load that several tokens bear together, ``share(state, *values)`` to what the first value has to
            bear and what it can bear [unit], for one state; the margin is their difference. None for other predicates.
        description: what it says, as a sentence over the parameters' names in braces,
            e.g. ``"{object} is within {region}"``.
    """

    name: str
    parameters: tuple[Parameter, ...]
    margin: Callable[..., FloatArray]
    unit: str = "1"
    scale: float = 1.0
    reads: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    static: bool = False
    functional: str | None = None
    maintained: bool = False
    description: str = ""
    denial: str = ""
    share: Callable[..., tuple[float, float]] | None = None

    def __call__(self, *arguments: str) -> "Literal":
        """Return the positive literal over slots, targets, symbols or `ANY`."""
        return Literal(self, arguments)

    def __repr__(self) -> str:
        return f"Predicate({self.name!r})"

    @property
    def functional_index(self) -> int | None:
        """Index of the functional parameter, or None."""
        names = [parameter.name for parameter in self.parameters]
        return names.index(self.functional) if self.functional is not None else None

    def evaluate(self, state: State, *values: Value) -> FloatArray:
        """Return the margin ``(...)`` of the atom over the values."""
        return self.margin(state, *values)

    def sentence(self, names: tuple[str, ...], positive: bool = True) -> str:
        """Say the atom in words, e.g. ``drum is within goal``."""
        template = self.denial if self.denial and not positive else self.description
        if not template:
            return Atom(self.name, names, positive).text
        said = template.format(**{p.name: n for p, n in zip(self.parameters, names, strict=True)})
        return said if positive or self.denial else f"it is not so that {said}"


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
