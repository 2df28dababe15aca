"""Durative actions and temporal problems: the output of the temporal encoder and the input of `pddl.temporal_text`.

A fluent has one value for its arguments: one or several objects, a number, or a truth value. A condition requires a
value at the start, at the end or throughout an action. An effect sets a value, or adds to a number, at the start or at
the end. All names are PDDL names (`pddl.naming`). Variables begin with a question mark.
"""

from dataclasses import dataclass, field
from typing import Literal

from hybrid_tamp.symbolic.pddl.operators import Fact, Typed

Value = tuple[str, ...] | int | bool
"""Objects or variables, a number, or a truth value."""

When = Literal["start", "over all", "end", "throughout"]
"""``over all`` begins after the effects at the start; ``throughout`` includes the start itself."""


@dataclass(frozen=True)
class Fluent:
    """A fluent.

    Attributes:
        name: its name.
        parameters: typed.
        kind: the kind of its values.
        values: the types of the objects in its value.
    """

    name: str
    parameters: tuple[Typed, ...]
    kind: Literal["truth", "number", "objects"] = "truth"
    values: tuple[str, ...] = ()


@dataclass(frozen=True)
class Condition:
    """The fluent has the value at some time of the action."""

    when: When
    fact: Fact
    value: Value = True


@dataclass(frozen=True)
class Effect:
    """The fluent takes the value at the start or at the end or, with `add`, changes by that number."""

    when: Literal["start", "end"]
    fact: Fact
    value: Value = True
    add: bool = False


@dataclass(frozen=True)
class DurativeAction:
    """A lifted durative action. Its duration is the value of a constant number [ms]."""

    name: str
    parameters: tuple[Typed, ...]
    duration: Fact
    conditions: tuple[Condition, ...]
    effects: tuple[Effect, ...]

    @property
    def facts(self) -> tuple[Fact, ...]:
        """The fluents with arguments in its conditions and effects."""
        return (*(condition.fact for condition in self.conditions), *(effect.fact for effect in self.effects))


@dataclass(frozen=True)
class TemporalDomain:
    """The part of a temporal problem that depends on the domain alone, never on tokens."""

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
        init: fluents with their values; those with a truth value only if they are true.
        goal: fluents with their values at the end.
        comments: (PDDL name, name of the user) pairs that differ.
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
