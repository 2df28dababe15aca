"""Durative actions and temporal problems, which the temporal encoder makes and `pddl.temporal_text` prints.

The value of a fluent is one or several objects, a number, or a truth value. A condition requires a value at the start,
at the end or throughout an action. An effect sets a value or increases a number, at the start or at the end of an
action. All names are PDDL names (`pddl.naming`). Variables begin with a question mark.
"""

from dataclasses import dataclass, field
from typing import Literal

from hybrid_tamp.symbolic.pddl.operators import Fact, Typed

Value = tuple[str, ...] | int | bool
"""Value of a fluent: a tuple of objects or variables, a number, or a truth value."""

When = Literal["start", "over all", "end", "throughout"]
"""Time of a condition. ``over all`` begins after the effects at the start. ``throughout`` includes the start."""


@dataclass(frozen=True)
class Fluent:
    """A state variable.

    Attributes:
        name: Name of the fluent.
        parameters: Pairs of (variable, type).
        kind: Kind of the fluent's value.
        values: Types of the objects in the value, if the kind is ``objects``.
    """

    name: str
    parameters: tuple[Typed, ...]
    kind: Literal["truth", "number", "objects"] = "truth"
    values: tuple[str, ...] = ()


@dataclass(frozen=True)
class Condition:
    """The condition that a fluent has a value at a given time of the action."""

    when: When
    fact: Fact
    value: Value = True


@dataclass(frozen=True)
class Effect:
    """An effect, which sets a fluent to a value. If `add` is True, the effect adds the value to the fluent."""

    when: Literal["start", "end"]
    fact: Fact
    value: Value = True
    add: bool = False


@dataclass(frozen=True)
class DurativeAction:
    """A lifted durative action. Its duration is the value of a constant fluent [ms]."""

    name: str
    parameters: tuple[Typed, ...]
    duration: Fact
    conditions: tuple[Condition, ...]
    effects: tuple[Effect, ...]

    @property
    def facts(self) -> tuple[Fact, ...]:
        """The fluents in the conditions and effects, with arguments."""
        return (*(condition.fact for condition in self.conditions), *(effect.fact for effect in self.effects))


@dataclass(frozen=True)
class TemporalDomain:
    """The part of a temporal problem that does not depend on the tokens of a task."""

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
        name: PDDL name of the problem.
        domain: Temporal planning domain of the problem.
        objects: Pairs of (object, type).
        init: Pairs of (fluent, initial value). False values are left out.
        goal: Pairs of (fluent, value at the end).
        comments: Pairs of (PDDL name, user's name), only where the two names differ.
    """

    name: str
    domain: TemporalDomain
    objects: tuple[Typed, ...]
    init: tuple[tuple[Fact, Value], ...]
    goal: tuple[tuple[Fact, Value], ...]
    comments: tuple[tuple[str, str], ...] = field(default=())


@dataclass(frozen=True)
class TimedAction:
    """One action of a temporal plan, with its start [s], name, arguments and duration [s]."""

    start: float
    name: str
    arguments: tuple[str, ...]
    duration: float
