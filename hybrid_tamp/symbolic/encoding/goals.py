"""Goals as planners state them: conjunctions of ground atoms."""

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.predicate import ANY
from hybrid_tamp.model.task import Task


def with_one_goal(task: Task) -> Task:
    """Return the task with its one ground goal.

    Raises:
        InputError: the goal leaves a choice, says what does not hold, or asks of a token what is not known of it.
    """
    for atom, token, sort in task.unsettled:
        wanted = f"'{atom.text}' asks for a member of {sort.name}, and whether {token.name} is one is not known"
        raise InputError([Issue("goal", wanted, remedy="probe the token")])
    first, *others = task.alternatives()
    if others:
        wanted = "a goal that names every token: the goal of a planning problem says that all of it holds"
        named = ", ".join(atom.text for atom in first.goal)
        remedy = f"name tokens instead of {ANY!r}; the nearest choice is {named}"
        raise InputError([Issue("goal", wanted, f"one with {len(others) + 1} choices", remedy=remedy)])
    denied = [atom for atom in first.goal if not atom.positive]
    if denied:
        raise InputError([Issue("goal", f"'{denied[0].text}': a goal says what holds", remedy="ask for its opposite")])
    return first
