"""Lifted operators and ground problems in typed STRIPS. The encoder makes the problems and planners solve them.

All names are PDDL names (`pddl.naming`). Variables begin with a question mark.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from hybrid_tamp.model.plan import PlannedAction

Fact = tuple[str, ...]
"""Name of a predicate, followed by its arguments. An argument is a variable, a constant or an object."""

Typed = tuple[str, str]
"""Pair of (name or ``?variable``, type)."""


@dataclass(frozen=True)
class Operator:
    """A lifted STRIPS action. The deletes are applied before the adds."""

    name: str
    parameters: tuple[Typed, ...]
    precondition: tuple[Fact, ...]
    add: tuple[Fact, ...]
    delete: tuple[Fact, ...]

    def bind(self, action: PlannedAction) -> dict[str, str]:
        """Return a dictionary that maps each parameter to its argument in an action of this operator."""
        return dict(zip((variable for variable, _ in self.parameters), action.arguments, strict=True))

    def effects(self, binding: Mapping[str, str], facts: set[Fact]) -> set[Fact]:
        """Return the facts that hold after the operator with the given binding is applied to the given facts."""
        kept = facts - {ground(fact, binding) for fact in self.delete}
        return kept | {ground(fact, binding) for fact in self.add}


def ground(fact: Fact, binding: Mapping[str, str]) -> Fact:
    """Replace the bound variables of a fact by their values."""
    return (fact[0], *(binding.get(argument, argument) for argument in fact[1:]))


def rename_arguments(action: PlannedAction, names: Mapping[str, str]) -> PlannedAction:
    """Rename the arguments of an action. `names` maps each old name to its new name."""
    return PlannedAction(action.name, tuple(names.get(argument, argument) for argument in action.arguments))


@dataclass(frozen=True)
class PlanningDomain:
    """The part of a planning problem that does not depend on the tokens of a task.

    Attributes:
        name: PDDL name of the domain.
        types: Pairs of (type, parent). The root parent is ``object``.
        constants: Pairs of (constant, type).
        predicates: Pairs of (predicate, typed parameters).
        operators: Lifted actions.
        comments: Pairs of (PDDL name, user's name), only where the two names differ.
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
