"""Search for the best lawful plan of a task with all strategies.

Independent goals are planned separately. If this gives no plan, the engine plans the whole task at once. To find the
fewest actions, a small task is first planned at once, and few groups of goals are also planned in turn. Needless
actions are dropped. For the makespan, goals are planned separately with different numbers of helpers, and
interchangeable tokens are rebound until no rebinding shortens the plan. Counts limit these searches. The deadline of
the command ends them, but shapes no plan.
"""

import time
from collections.abc import Collection, Sequence
from dataclasses import replace

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.expectation import Expectations
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.preferences import prefer
from hybrid_tamp.symbolic.strategies.results import choose_best, not_found, unsolvable
from hybrid_tamp.symbolic.strategies.search import Planner, Search, SearchResult
from hybrid_tamp.symbolic.strategies.with_facts import STOPPING, is_within_reach, plan_with_facts
from hybrid_tamp.symbolic.whereabouts.relax import relax_task
from hybrid_tamp.symbolic.whereabouts.situate import Excluded, Situation


def find_plan(
    task: Task,
    planner: Planner,
    deadline: Deadline | None = None,
    *,
    relax: bool = False,
    expectations: Expectations | None = None,
) -> SearchResult:
    """Return a plan that the law checker accepted, or the reason why there is none.

    Each action comes from a plan that the validator of unified-planning accepted. If the goal leaves a choice, the
    best plan of all alternatives is returned. The task is proven unsolvable only if every alternative is.

    Args:
        task: Task to plan.
        planner: Running planner process.
        deadline: Deadline of the command. By default, the time limit of the task counts from now.
        relax: Whether the delete relaxation examines the task before the engine. This is useful if other tasks will be
            planned when this task has no plan, because some engines never end without a plan.
        expectations: Expectations of instances, which several calls may share.

    Returns:
        The result. If a limit ended the search for a better plan, the result names the limit.

    Raises:
        InputError: If the engine is unknown or not installed, or if the goal cannot be compiled.
        LimitReached: If a time or memory limit was reached before any plan was found.
    """
    deadline = deadline or Deadline.after(task.limits.time)
    # A goal that crowds a place is impossible. A task file without another goal is refused.
    alternatives = [each for each in task.alternatives() if each.crowding() is None] or list(task.alternatives())
    if len(alternatives) == 1:
        return _plan_with_preferences(Search(alternatives[0], planner, deadline, expectations=expectations), relax)
    return _plan_alternatives(alternatives, planner, deadline, expectations)


def _plan_with_preferences(search: Search, relax: bool) -> SearchResult:
    """Plan a task with the preferences of its blocks, and without them if there is no plan or if helpers have to wait.

    `search` is a new search for a plan of the task.

    Raises:
        LimitReached: If a limit was reached before any plan was found.
    """
    preferred = prefer(search.task)
    if preferred is None:
        return _plan_whereabouts(search, plan_with_facts(search, relax))
    first = Search(preferred, search.planner, search.deadline, search.task, expectations=search.expectations)
    found = plan_with_facts(first, relax or search.task.planner not in STOPPING)
    if found.fewest == "proven fewest":
        found = replace(found, fewest="no shorter one found")  # Without the preferences, a shorter one may exist.
    if found.status == "solved" and not first.waits:
        return _plan_whereabouts(search, found)
    try:
        other = _plan_whereabouts(search, plan_with_facts(search, relax))
    except LimitReached as reached:
        if found.plan is None:
            raise
        return replace(found, stopped=reached)
    return min(other, found, key=lambda each: (each.cost, each.plan.makespan if each.plan else 0.0))


def _plan_whereabouts(search: Search, result: SearchResult) -> SearchResult:
    """Plan a task with the whereabouts of its tokens if it has no plan with the feasibility facts of its initial state.

    `search`, with these facts, gave `result`. It is returned if it is a plan, or if no block changes a pose of a fact.

    Facts at the expected ends of movements guide the search. If a condition fails in a predicted state of a plan, the
    search repeats without this fact. Only optimistic facts prove that the task has no plan. With these facts, a
    condition holds unless an upper bound shows that the condition fails at every pose of a node.

    Raises:
        LimitReached: If a limit was reached before any plan was found.
    """
    task = search.task
    situation = Situation(task)
    if situation.tracking.parameters and result.shorter_refused:
        return _shorten(situation, search, result)
    if result.status not in ("unsolvable", "plan_refused") or not situation.tracking.parameters:
        return result
    relaxed = Search(relax_task(task, situation.tracking), search.planner, search.deadline)
    if not is_within_reach(relaxed):
        return result if result.status == "unsolvable" else unsolvable(relaxed, task)
    optimistic = _situated_search(situation, search, optimistic=True)
    if not is_within_reach(optimistic):
        return unsolvable(optimistic, task)
    refusals: list[str] = []
    if (with_nodes := _plan_with_nodes(situation, search, refusals)) is not None:
        return with_nodes
    found = plan_with_facts(optimistic, relax=False)
    return found if found.status in ("solved", "unsolvable") else not_found(found, (*refusals, *optimistic.refusals))


def _plan_with_nodes(situation: Situation, begun: Search, refusals: list[str]) -> SearchResult | None:
    """Plan with the facts at the expected ends of movements. Return None if there is no plan, and extend `refusals`."""
    excluded: set[Excluded] = set()
    for _ in range(situation.task.limits.refinements + 1):
        search = _situated_search(situation, begun, excluded=excluded)
        found = plan_with_facts(search, relax=True)
        if found.status == "solved":
            return found
        if not (more := situation.excluded(search.broken) - excluded):
            refusals += search.refusals
            break
        excluded |= more
    return None


def _shorten(situation: Situation, search: Search, result: SearchResult) -> SearchResult:
    """Return a plan with whereabouts if it has fewer actions than a plan without, or else the plan without."""
    try:
        found = _plan_with_nodes(situation, search, [])
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


def _plan_alternatives(
    alternatives: Sequence[Task], planner: Planner, deadline: Deadline, expectations: Expectations | None
) -> SearchResult:
    """Plan the alternatives of a goal with a choice, the nearest first, and return the best result.

    If several plans are equally good, the plan of the nearest alternative is returned.

    Raises:
        LimitReached: If a limit was reached before any plan was found.
    """
    began = time.monotonic()
    found: list[SearchResult] = []
    stopped: LimitReached | None = None
    for each in alternatives:
        try:
            search = Search(each, planner, deadline, expectations=expectations)
            found.append(_plan_with_preferences(search, relax=True))
            stopped = found[-1].stopped
        except LimitReached as reached:
            if all(result.plan is None for result in found):
                raise
            stopped = reached
        plan = found[-1].plan
        if stopped is not None or (plan is not None and not plan.actions):
            break  # No plan is shorter than the empty plan.
    return choose_best(found, time.monotonic() - began, stopped)
