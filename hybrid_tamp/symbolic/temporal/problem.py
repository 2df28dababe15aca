"""Durative actions and their problems: what the temporal encoder makes, `unified` and `text` read.

A fluent has one value for its arguments: one or several objects, a number, or a truth value, which is no object at
all: the fluent is then true of its arguments or is not. Conditions ask for a value, effects give one or add to a
number, each at the start or at the end of an action; conditions also all the while in between. All names are PDDL
names already (`pddl.naming`); variables begin with a question mark.
"""

from dataclasses import dataclass, field
from typing import Literal

from hybrid_tamp.symbolic.pddl.operators import Fact, Typed

Value = tuple[str, ...] | int | bool
"""Objects or variables, a number, or a truth value."""

When = Literal["start", "over all", "end", "throughout"]
"""``over all`` begins when the start has taken effect; ``throughout`` is from the start itself to the end."""


@dataclass(frozen=True)
class Fluent:
    """A fluent.

    Attributes:
        name: its name.
        parameters: typed.
        kind: of its values.
        values: the types of the objects that are its values.
    """

    name: str
    parameters: tuple[Typed, ...]
    kind: Literal["truth", "number", "objects"] = "truth"
    values: tuple[str, ...] = ()


@dataclass(frozen=True)
class Condition:
    """At a time the fluent has the value."""

    when: When
    fact: Fact
    value: Value = True


@dataclass(frozen=True)
class Effect:
    """At a time the fluent takes the value; or, with `add`, changes by that number."""

    when: Literal["start", "end"]
    fact: Fact
    value: Value = True
    add: bool = False


@dataclass(frozen=True)
class DurativeAction:
    """A lifted durative action; its duration is the value of a static number [ms]."""

    name: str
    parameters: tuple[Typed, ...]
    duration: Fact
    conditions: tuple[Condition, ...]
    effects: tuple[Effect, ...]

    @property
    def facts(self) -> tuple[Fact, ...]:
        """The fluents, with their arguments, that it asks for or changes."""
        return (*(condition.fact for condition in self.conditions), *(effect.fact for effect in self.effects))


@dataclass(frozen=True)
class TemporalDomain:
    """What depends on the domain alone, never on one problem's tokens."""

    name: str
    types: tuple[Typed, ...]
    constants: tuple[Typed, ...]
    fluents: tuple[Fluent, ...]
    actions: tuple[DurativeAction, ...]
    comments: tuple[tuple[str, str], ...] = field(default=())


@dataclass(frozen=True)
class TemporalProblem:
    """A ground problem of a temporal domain.

    Attributes:
        name: name of the problem.
        domain: its domain.
        objects: names and types.
        init: fluents with their values; of truths those that are true.
        goal: fluents with the values that they have at the end.
        comments: PDDL name to the user's own, where they differ.
    """

    name: str
    domain: TemporalDomain
    objects: tuple[Typed, ...]
    init: tuple[tuple[Fact, Value], ...]
    goal: tuple[tuple[Fact, Value], ...]
    comments: tuple[tuple[str, str], ...] = field(default=())


@dataclass(frozen=True)
class TimedAction:
    """One action of a temporal plan: its start [s], name, objects, and duration [s]."""

    start: float
    name: str
    arguments: tuple[str, ...]
    duration: float
