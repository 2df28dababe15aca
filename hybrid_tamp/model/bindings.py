"""Enumeration of bindings, which map a block's roles or a predicate's parameters to tokens and symbols."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from hybrid_tamp.model.predicate import Literal, Value, name_of
from hybrid_tamp.model.token import Token

Choices = Mapping[str, Sequence[Value]]
"""Maps each role to its possible values."""
Holds = Callable[[Literal, Mapping[str, Value]], bool]
"""Function ``holds(condition, bound)`` that tests a condition. `bound` maps each role to its value."""


@dataclass(frozen=True)
class _Step:
    """A step of the enumeration. The step binds one or more roles at the same time.

    Attributes:
        roles: roles that the step binds.
        rows: possible combinations of values for the roles.
        conditions: conditions whose last unbound role is bound in this step.
    """

    roles: tuple[str, ...]
    rows: Sequence[tuple[Value, ...]]
    conditions: tuple[Literal, ...]


def enumerate_bindings(
    choices: Choices, conditions: Iterable[Literal] = (), holds: Holds | None = None
) -> Iterator[dict[str, Value]]:
    """Yield every binding of roles to values that satisfies the conditions.

    A binding never has the same token in two roles, but can have the same symbol in several roles. The bindings are in
    the order of nested loops over the roles. Each condition is evaluated as soon as its roles are bound. If adjacent
    roles are the arguments of a relation over symbols, only the rows of the relation are enumerated.

    Args:
        choices: maps each role to its possible values.
        conditions: literals that must hold. An argument that is not a role is a symbol.
        holds: function that returns whether a condition holds for a binding. None means that all conditions hold.
    """
    conditions = list(conditions)
    if holds is not None and not all(holds(each, {}) for each in conditions if not _roles(each, choices)):
        return
    steps = _plan_steps(choices, conditions)

    def extend(bound: dict[str, Value], index: int) -> Iterator[dict[str, Value]]:
        if index == len(steps):
            yield bound
            return
        step = steps[index]
        for row in step.rows:
            # A token is equal only to itself, so `in` finds the same token.
            if any(isinstance(value, Token) and value in bound.values() for value in row):
                continue
            more = bound | dict(zip(step.roles, row, strict=True))
            if holds is None or all(holds(condition, more) for condition in step.conditions):
                yield from extend(more, index + 1)

    yield from extend({}, 0)


def names_of(bound: Mapping[str, Value]) -> tuple[str, ...]:
    """Return the names of the tokens and symbols of a binding, in the order of its roles."""
    return tuple(map(name_of, bound.values()))


def order_roles(choices: Choices, conditions: Iterable[Literal]) -> Choices:
    """Return the choices, with the roles in the order of their first conditions. Conditions are then tested early."""
    roles = dict.fromkeys(argument for literal in conditions for argument in literal.arguments if argument in choices)
    return {role: choices[role] for role in (*roles, *(role for role in choices if role not in roles))}


def _plan_steps(choices: Choices, conditions: Sequence[Literal]) -> list[_Step]:
    steps: list[_Step] = []
    open_roles, bound = list(choices), set[str]()
    while open_roles:
        relation = next((literal for literal in conditions if _gives_rows(literal, open_roles)), None)
        roles = (open_roles[0],) if relation is None else relation.arguments
        rows: Sequence[tuple[Value, ...]] = [(value,) for value in choices[roles[0]]]
        if relation is not None:
            allowed = [frozenset(choices[role]) for role in roles]
            rows = [row for row in relation.predicate.rows or () if all(map(frozenset.__contains__, allowed, row))]
        after = bound | set(roles)
        ready = [each for each in conditions if each is not relation and _roles(each, choices) <= after]
        steps.append(_Step(roles, rows, tuple(each for each in ready if not _roles(each, choices) <= bound)))
        bound, open_roles = after, open_roles[len(roles) :]
    return steps


def _roles(literal: Literal, choices: Choices) -> set[str]:
    return {argument for argument in literal.arguments if argument in choices}


def _gives_rows(literal: Literal, open_roles: Sequence[str]) -> bool:
    """Return whether the literal is a positive relation over symbols whose arguments are the next unbound roles."""
    next_roles = tuple(open_roles[: len(literal.arguments)])
    return literal.positive and literal.predicate.rows is not None and literal.arguments == next_roles
