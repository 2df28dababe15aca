"""Search for a plan with the whereabouts of tokens, if the facts of the initial state give no plan."""

from collections.abc import Callable, Collection
from dataclasses import replace

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.symbolic.strategies.results import is_within_reach, not_found, unsolvable
from hybrid_tamp.symbolic.strategies.search import Search, SearchResult
from hybrid_tamp.symbolic.whereabouts.relax import relax_task
from hybrid_tamp.symbolic.whereabouts.situate import Excluded, Situation

Plan = Callable[[Search, bool], SearchResult]
"""Function of a search and `relax` that searches for a plan with the facts of one task."""


def plan_whereabouts(search: Search, result: SearchResult, plan: Plan) -> SearchResult:
    """Plan a task with the whereabouts of its tokens if it has no plan with the feasibility facts of its initial state.

    `search`, with these facts, gave `result`. It is returned if it is a plan, or if no block changes a pose of a fact.
    `plan` searches for a plan with the facts of one task.

    Facts at the expected ends of movements guide the search. If a condition fails in a predicted state of a plan, the
    search repeats without this fact. Only optimistic facts prove that the task has no plan. With these facts, a
    condition holds unless an upper bound shows that the condition fails at every pose of a node.

    Raises:
        LimitReached: If a limit was reached before any plan was found.
    """
    task = search.task
    situation = Situation(task)
    if situation.tracking.parameters and result.shorter_refused:
        return _shorten(situation, search, result, plan)
    if result.status not in ("unsolvable", "plan_refused") or not situation.tracking.parameters:
        return result
    relaxed = Search(relax_task(task, situation.tracking), search.planner, search.deadline)
    if not is_within_reach(relaxed):
        return result if result.status == "unsolvable" else unsolvable(relaxed, task)
    optimistic = _situated_search(situation, search, optimistic=True)
    if not is_within_reach(optimistic):
        return unsolvable(optimistic, task)
    refusals: list[str] = []
    if (with_nodes := _plan_with_nodes(situation, search, refusals, plan)) is not None:
        return with_nodes
    found = plan(optimistic, False)
    return found if found.status in ("solved", "unsolvable") else not_found(found, (*refusals, *optimistic.refusals))


def _plan_with_nodes(situation: Situation, begun: Search, refusals: list[str], plan: Plan) -> SearchResult | None:
    """Plan with the facts at the expected ends of movements. Return None if there is no plan, and extend `refusals`."""
    excluded: set[Excluded] = set()
    for _ in range(situation.task.limits.refinements + 1):
        search = _situated_search(situation, begun, excluded=excluded)
        found = plan(search, True)
        if found.status == "solved":
            return found
        if not (more := situation.excluded(search.broken) - excluded):
            refusals += search.refusals
            break
        excluded |= more
    return None


def _shorten(situation: Situation, search: Search, result: SearchResult, plan: Plan) -> SearchResult:
    """Return a plan with whereabouts if it has fewer actions than a plan without, or else the plan without."""
    try:
        found = _plan_with_nodes(situation, search, [], plan)
    except LimitReached as reached:
        return replace(result, stopped=reached)
    return result if found is None else min(result, found, key=lambda each: each.cost)


def _situated_search(
    situation: Situation, begun: Search, *, optimistic: bool = False, excluded: Collection[Excluded] = ()
) -> Search:
    task = situation.situated_task(optimistic, excluded)
    return Search(
        task, begun.planner, begun.deadline, situation.task, situation.original_plan, expectations=begun.expectations
    )
