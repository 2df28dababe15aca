"""Lifted operators and ground problems in plain STRIPS with types: what the encoder makes and planners read.

All names are PDDL names already (`pddl.naming`); variables begin with a question mark.
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
    """A lifted STRIPS action; effects delete before they add."""

    name: str
    parameters: tuple[Typed, ...]
    precondition: tuple[Fact, ...]
    add: tuple[Fact, ...]
    delete: tuple[Fact, ...]

    def bind(self, action: PlannedAction) -> dict[str, str]:
        """Return the parameters with what an action of this operator binds them to."""
        return dict(zip((variable for variable, _ in self.parameters), action.arguments, strict=True))

    def effects(self, binding: Mapping[str, str], facts: set[Fact]) -> set[Fact]:
        """Return the facts after the operator, whose parameters are bound, has been applied to them."""
        kept = facts - {ground(fact, binding) for fact in self.delete}
        return kept | {ground(fact, binding) for fact in self.add}


def ground(fact: Fact, binding: Mapping[str, str]) -> Fact:
    """Replace the variables of a fact that are bound."""
    return (fact[0], *(binding.get(argument, argument) for argument in fact[1:]))


def rename_arguments(action: PlannedAction, names: Mapping[str, str]) -> PlannedAction:
    """Return the action with other objects in place of those that are named."""
    return PlannedAction(action.name, tuple(names.get(argument, argument) for argument in action.arguments))


@dataclass(frozen=True)
class PlanningDomain:
    """What depends on the domain alone, never on one problem's tokens.

    Attributes:
        name: name of the domain.
        types: (type, parent) pairs; the root parent is ``object``.
        constants: domain-wide objects (symbols).
        predicates: predicate to its typed parameters.
        operators: the lifted actions.
        comments: PDDL name to the user's own, where they differ.
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
