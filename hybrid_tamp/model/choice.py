"""Goals with a choice: `ANY` in an atom stands for any token or symbol.

Such a goal is the disjunction of several ground goals.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import product
from math import prod

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.predicate import ANY, Atom, Predicate

MOST_ALTERNATIVES = 1000
"""Largest number of ground goals of a goal with a choice."""

Goal = tuple[Atom, ...]


def ground_goals(
    goal: Goal,
    predicates: Mapping[str, Predicate],
    groundings: Callable[[Atom], tuple[Atom, ...]],
    margin: Callable[[Atom], float],
) -> list[Goal]:
    """Return the ground goals of a goal with a choice, the nearest first.

    The nearest goal has the largest sum of the margins of its chosen atoms in the initial state, in units of
    violation; the order of the tokens breaks ties. Goals with contradictory atoms are omitted.

    Args:
        goal: the goal.
        predicates: the domain's predicates by name.
        groundings: returns the ground atoms of an atom with a choice.
        margin: returns the margin of a ground atom in the initial state.

    Raises:
        InputError: there are more than `MOST_ALTERNATIVES`, or none.
    """
    choices = [groundings(atom) if _open(atom) else (atom,) for atom in goal]
    count = prod(map(len, choices))
    if count > MOST_ALTERNATIVES:
        wanted = f"a goal must leave at most {MOST_ALTERNATIVES} choices"
        raise InputError([Issue("goal", wanted, str(count), remedy=f"name tokens instead of {ANY!r}")])
    every = dict.fromkeys(tuple(dict.fromkeys(atoms)) for atoms in product(*choices))
    goals = [each for each in every if _compatible(predicates, each)]
    if not goals:
        wanted = f"tokens or symbols for {ANY!r} with which all of the goal can hold at once"
        raise InputError([Issue("goal", wanted, "none")])
    given = {atom for atom in goal if not _open(atom)}

    def distance(each: Goal) -> float:
        return -sum(margin(atom) / predicates[atom.predicate].scale for atom in each if atom not in given)

    return sorted(goals, key=distance)


def _open(atom: Atom) -> bool:
    return atom.positive and ANY in atom.arguments


def _compatible(predicates: Mapping[str, Predicate], goal: Iterable[Atom]) -> bool:
    """Say whether no functional predicate has two values in a ground goal."""
    keys = [key for atom in goal for key in _keys(predicates[atom.predicate], atom)]
    return len(set(keys)) == len(keys)


def _keys(predicate: Predicate, atom: Atom) -> Iterator[tuple[object, ...]]:
    index = predicate.functional_index
    if index is not None and atom.positive:
        yield atom.predicate, atom.arguments[:index], atom.arguments[index + 1 :]
