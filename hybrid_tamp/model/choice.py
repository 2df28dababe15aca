"""Goals with a choice: `ANY` in an atom stands for any token or symbol at that place.

A task with such a goal is as good as a number of tasks with ground goals, each of which would do.
"""

from collections.abc import Iterable, Iterator
from itertools import product
from math import prod
from typing import TYPE_CHECKING

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.predicate import ANY, Atom

if TYPE_CHECKING:
    from hybrid_tamp.model.domain import Domain
    from hybrid_tamp.model.task import Task

MOST_ALTERNATIVES = 1000
"""A goal that leaves more to choose from is refused."""


def alternatives(task: "Task") -> tuple["Task", ...]:
    """Return the tasks with the ground goals that a goal leaves to choose from, the nearest first.

    The nearest is the one whose chosen atoms have the largest margins in the initial state, in units of violation
    and summed up; ties are broken by the order of the tokens. Atoms that contradict each other are left out.

    Raises:
        InputError: there are more than `MOST_ALTERNATIVES`, or none.
    """
    choices = [task.groundings(atom) if _open(atom) else (atom,) for atom in task.goal]
    count = prod(map(len, choices))
    if count > MOST_ALTERNATIVES:
        wanted = f"a goal leaves at most {MOST_ALTERNATIVES} choices"
        raise InputError([Issue("goal", wanted, str(count), remedy=f"name tokens instead of {ANY!r}")])
    every = dict.fromkeys(tuple(dict.fromkeys(atoms)) for atoms in product(*choices))
    goals = [goal for goal in every if compatible(task.domain, goal)]
    if not goals:
        wanted = f"tokens or symbols for {ANY!r} with which all of the goal can hold at once"
        raise InputError([Issue("goal", wanted, "none")])
    given = {atom for atom in task.goal if not _open(atom)}
    goals.sort(key=lambda goal: -sum(_nearness(task, atom) for atom in goal if atom not in given))
    return tuple(task.replaced(goal=goal) for goal in goals)


def _open(atom: Atom) -> bool:
    return atom.positive and ANY in atom.arguments


def _nearness(task: "Task", atom: Atom) -> float:
    return task.margin(atom) / task.domain.predicate_by_name[atom.predicate].scale


def compatible(domain: "Domain", goal: Iterable[Atom]) -> bool:
    """Say whether no functional predicate has two values in a ground goal."""
    keys = [key for atom in goal for key in _keys(domain, atom)]
    return len(set(keys)) == len(keys)


def _keys(domain: "Domain", atom: Atom) -> Iterator[tuple[object, ...]]:
    index = domain.predicate_by_name[atom.predicate].functional_index
    if index is not None and atom.positive:
        yield atom.predicate, atom.arguments[:index], atom.arguments[index + 1 :]
