"""Goals as planners state them: conjunctions of ground atoms."""

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.predicate import ANY
from hybrid_tamp.model.task import Task


def sole_alternative(task: Task) -> Task:
    """Return the task with its one ground goal.

    Raises:
        InputError: the goal leaves a choice.
    """
    first, *others = task.alternatives()
    if others:
        wanted = "a goal that names every token: the goal of a planning problem says that all of it holds"
        named = ", ".join(map(str, first.goal))
        remedy = f"name tokens instead of {ANY!r}; the nearest choice is {named}"
        raise InputError([Issue("goal", wanted, f"one with {len(others) + 1} choices", remedy=remedy)])
    return first
