"""Goals with a choice. An atom with a choice contains `ANY` in place of a token or symbol.

A goal with a choice is the disjunction of several ground goals.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import product
from math import prod

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.predicate import ANY, Atom, Predicate

MOST_ALTERNATIVES = 1000
"""Largest number of ground goals that a goal with a choice may have."""

Goal = tuple[Atom, ...]


def ground_goals(
    goal: Goal,
    predicates: Mapping[str, Predicate],
    groundings: Callable[[Atom], tuple[Atom, ...]],
    margin: Callable[[Atom], float],
) -> list[Goal]:
    """Return the ground goals of a goal with a choice, the nearest goal first.

    The nearest goal has the largest sum of the chosen atoms' margins in the initial state. Each margin is divided by
    the scale of its predicate. The order of the tokens breaks ties. Goals with contradictory atoms are omitted.

    Args:
        goal: goal with a choice.
        predicates: maps the name of each predicate of the domain to the predicate.
        groundings: function that returns the ground atoms of an atom with a choice.
        margin: function that returns the margin of a ground atom in the initial state.

    Raises:
        InputError: if the goal has more than `MOST_ALTERNATIVES` combinations of atoms or no ground goal.
    """
    choices = [groundings(atom) if _open(atom) else (atom,) for atom in goal]
    count = prod(map(len, choices))
    if count > MOST_ALTERNATIVES:
        wanted = f"a goal must have at most {MOST_ALTERNATIVES} combinations of choices"
        raise InputError([Issue("goal", wanted, str(count), remedy=f"replace {ANY!r} by names")])
    every = dict.fromkeys(tuple(dict.fromkeys(atoms)) for atoms in product(*choices))
    goals = [each for each in every if _compatible(predicates, each)]
    if not goals:
        wanted = f"all goal atoms must be true at the same time for at least one choice of values for {ANY!r}"
        raise InputError([Issue("goal", wanted, "no such choice")])
    given = {atom for atom in goal if not _open(atom)}

    def distance(each: Goal) -> float:
        return -sum(margin(atom) / predicates[atom.predicate].scale for atom in each if atom not in given)

    return sorted(goals, key=distance)


def _open(atom: Atom) -> bool:
    return atom.positive and ANY in atom.arguments


def _compatible(predicates: Mapping[str, Predicate], goal: Iterable[Atom]) -> bool:
    """Return whether every functional predicate has at most one value in a ground goal."""
    keys = [key for atom in goal for key in _keys(predicates[atom.predicate], atom)]
    return len(set(keys)) == len(keys)


def _keys(predicate: Predicate, atom: Atom) -> Iterator[tuple[object, ...]]:
    index = predicate.functional_index
    if index is not None and atom.positive:
        yield atom.predicate, atom.arguments[:index], atom.arguments[index + 1 :]
