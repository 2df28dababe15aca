"""Lifted operators and ground problems in STRIPS with types: the output of the encoder and the input of planners.

All names are PDDL names (`pddl.naming`). Variables begin with a question mark.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from hybrid_tamp.model.plan import PlannedAction

Fact = tuple[str, ...]
"""A predicate's name and its arguments: variables, constants or objects."""

Typed = tuple[str, str]
"""A name (or ``?variable``) and its type."""


@dataclass(frozen=True)
class Operator:
    """A lifted STRIPS action. Deletes precede adds."""

    name: str
    parameters: tuple[Typed, ...]
    precondition: tuple[Fact, ...]
    add: tuple[Fact, ...]
    delete: tuple[Fact, ...]

    def bind(self, action: PlannedAction) -> dict[str, str]:
        """Return the parameters with the arguments of an action of this operator."""
        return dict(zip((variable for variable, _ in self.parameters), action.arguments, strict=True))

    def effects(self, binding: Mapping[str, str], facts: set[Fact]) -> set[Fact]:
        """Return the facts after the operator with bound parameters has been applied to them."""
        kept = facts - {ground(fact, binding) for fact in self.delete}
        return kept | {ground(fact, binding) for fact in self.add}


def ground(fact: Fact, binding: Mapping[str, str]) -> Fact:
    """Return the fact with the values of its bound variables."""
    return (fact[0], *(binding.get(argument, argument) for argument in fact[1:]))


def rename_arguments(action: PlannedAction, names: Mapping[str, str]) -> PlannedAction:
    """Return the action with each object in `names` replaced."""
    return PlannedAction(action.name, tuple(names.get(argument, argument) for argument in action.arguments))


@dataclass(frozen=True)
class PlanningDomain:
    """The part of a planning problem that depends on the domain alone, never on tokens.

    Attributes:
        name: name of the domain.
        types: (type, parent) pairs; the root parent is ``object``.
        constants: domain-wide objects (symbols).
        predicates: predicate to its typed parameters.
        operators: the lifted actions.
        comments: (PDDL name, name of the user) pairs that differ.
    """

    name: str
    types: tuple[Typed, ...]
    constants: tuple[Typed, ...]
    predicates: tuple[tuple[str, tuple[Typed, ...]], ...]
    operators: tuple[Operator, ...]
    comments: tuple[tuple[str, str], ...] = field(default=())


@dataclass(frozen=True)
class PlanningProblem:
    """A ground problem of a planning domain."""

    name: str
    domain: PlanningDomain
    objects: tuple[Typed, ...]
    init: tuple[Fact, ...]
    goal: tuple[Fact, ...]
    comments: tuple[tuple[str, str], ...] = field(default=())
