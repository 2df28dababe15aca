"""Strategy that plans the whole task at once."""

from math import prod

from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.engines.planner_process import PlannerAnswer
from hybrid_tamp.symbolic.engines.registry import FIRST, SHORTENING
from hybrid_tamp.symbolic.strategies.search import Candidate, Search

WHOLE = "the whole task at once"

MOST_FACTS = 1000
"""Largest number of possible feasibility facts of a small task."""


def is_small(task: Task) -> bool:
    """Return whether a task is planned at once before its goals are planned separately, to find the fewest actions."""
    return count_facts(task) <= MOST_FACTS


def count_facts(task: Task) -> int:
    """Return the number of possible feasibility facts of a task, without relations over symbols."""
    predicates = [each for each in task.domain.static_predicates if each.rows is None]
    return sum(prod(len(task.values_of(each.sort)) for each in predicate.parameters) for predicate in predicates)


def plan_at_once(search: Search, engine: str) -> tuple[PlannerAnswer, Candidate | None]:
    """Return the answer of an engine for the whole task, and its lawful plan or None.

    Raises:
        LimitReached: If a limit is reached.
    """
    with search.stage("compiling"):
        problem = search.compilation.problem
    with search.limits_of_request() as limits:
        answer = search.planner.solve(problem, engine, limits)
    best = search.judge_actions(WHOLE, answer.actions) if answer.status == "solved" else None
    if best is None and answer.status == "solved" and engine == SHORTENING:
        # A condition may fail in the predicted states of the shorter plan only.
        return plan_at_once(search, FIRST)
    return answer, best
