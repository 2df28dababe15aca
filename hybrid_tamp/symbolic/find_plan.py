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
from hybrid_tamp.model.plan import Fewest
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.engines.planner_process import PlannerAnswer
from hybrid_tamp.symbolic.engines.registry import FIRST, SHORTENING
from hybrid_tamp.symbolic.relaxation import may_be_solvable
from hybrid_tamp.symbolic.strategies.best_alternative import choose_best
from hybrid_tamp.symbolic.strategies.fewest import count_facts, judge_fewest, wants_fewest
from hybrid_tamp.symbolic.strategies.goals_apart import plan_goals_apart
from hybrid_tamp.symbolic.strategies.in_turn import plan_goals_in_turn
from hybrid_tamp.symbolic.strategies.needless import drop_needless
from hybrid_tamp.symbolic.strategies.rebinding import rebind, swap_tokens
from hybrid_tamp.symbolic.strategies.search import Candidate, Planner, Search, SearchResult
from hybrid_tamp.symbolic.whereabouts.relax import relax_task
from hybrid_tamp.symbolic.whereabouts.situate import Excluded, Situation

WHOLE = "the whole task at once"
REFUSED = "The plans that were found fail in their predicted states: "

MOST_AT_ONCE = 1000
"""Largest number of possible feasibility facts of a task that is planned at once before its goals are separated."""

_DECOMPOSING = (SHORTENING, FIRST, "symk", "enhsp", "pyperplan")
"""Engines that may plan goals separately. They stop if there is no plan, and do not guarantee the fewest actions."""


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
        search = Search(alternatives[0], planner, deadline, expectations=expectations)
        return _plan_whereabouts(search, _plan(search, relax))
    return _plan_alternatives(alternatives, planner, deadline, expectations)


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
    if not _is_within_reach(relaxed):
        return result if result.status == "unsolvable" else _unsolvable(relaxed, task)
    optimistic = _situated_search(situation, search, optimistic=True)
    if not _is_within_reach(optimistic):
        return _unsolvable(optimistic, task)
    refusals: list[str] = []
    if (with_nodes := _plan_with_nodes(situation, search, refusals)) is not None:
        return with_nodes
    found = _plan(optimistic, relax=False)
    return found if found.status in ("solved", "unsolvable") else _not_found(found, (*refusals, *optimistic.refusals))


def _plan_with_nodes(situation: Situation, begun: Search, refusals: list[str]) -> SearchResult | None:
    """Plan with the facts at the expected ends of movements. Return None if there is no plan, and extend `refusals`."""
    excluded: set[Excluded] = set()
    for _ in range(situation.task.limits.refinements + 1):
        search = _situated_search(situation, begun, excluded=excluded)
        found = _plan(search, relax=True)
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


def _unsolvable(search: Search, task: Task) -> SearchResult:
    answer = PlannerAnswer("unsolvable", (), search.elapsed, task.planner)
    return SearchResult(answer, None, stages=dict(search.stages), task=task)


def _not_found(result: SearchResult, refusals: Sequence[str]) -> SearchResult:
    """Return the result of a search with facts that prove nothing."""
    said = f"{REFUSED}{'; '.join(dict.fromkeys(refusals))}." if refusals else result.answer.message
    answer = replace(result.answer, status="not_found", message=said)
    return replace(result, answer=answer, refusal="")


def _plan(search: Search, relax: bool) -> SearchResult:
    """Search for a plan with the facts of one task.

    Raises:
        LimitReached: If a limit was reached before any plan was found.
    """
    task, original = search.task, search.original
    answer: PlannerAnswer | None = None
    stopped: LimitReached | None = None
    if relax and not _is_within_reach(search):
        return _unsolvable(search, original)
    fewest: Fewest | None = None
    try:
        answer, best = _search(search)
        if best is not None and task.objective != "makespan":
            fewest = judge_fewest(search, answer, best)
    except LimitReached as reached:
        if search.best is None:
            raise
        best, stopped = search.best, reached
    if best is not None:
        answer = PlannerAnswer("solved", best.plan.actions, search.elapsed, task.planner, validated=True)
        refused = bool(search.broken) and wants_fewest(task)
        return SearchResult(answer, best.plan, "", best.way, dict(search.stages), original, stopped, fewest, refused)
    assert answer is not None, "the engine was not asked for a plan of the whole task"
    refusal = search.refusals[-1] if search.refusals and answer.status == "solved" else ""
    answer = replace(answer, seconds=search.elapsed)
    return SearchResult(answer, None, refusal, stages=dict(search.stages), task=original)


def _is_within_reach(search: Search) -> bool:
    """Return whether the goal can be reached if no fact is ever deleted."""
    with search.stage("compiling"):
        return may_be_solvable(search.compilation.problem)


def _search(search: Search) -> tuple[PlannerAnswer | None, Candidate | None]:
    """Return the engine's answer for the whole task, or None if it was not asked, and the best plan, or None."""
    task, answer = search.task, None
    at_once = wants_fewest(task) and count_facts(task) <= MOST_AT_ONCE
    best = None if at_once else _plan_apart(search)
    engines = (search.engine, FIRST) if search.engine == SHORTENING else (search.engine,)
    for engine in engines if best is None else ():
        with search.stage("compiling"):
            problem = search.compilation.problem
        with search.limits_of_request() as limits:
            answer = search.planner.solve(problem, engine, limits)
        best = search.judge_actions(WHOLE, answer.actions) if answer.status == "solved" else None
        if best is not None or answer.status != "solved":
            break  # Otherwise, a condition fails in the predicted states, perhaps only in those of the shorter plan.
    if at_once and answer is not None and best is not None and answer.fewest != "proven fewest":
        best = min(filter(None, (best, _plan_apart(search))), key=lambda each: len(each.plan.actions))
    if best is not None and (answer is None or answer.fewest != "proven fewest"):
        best = drop_needless(search, best)
    if best is not None:
        best = rebind(search, best) if task.objective == "makespan" else swap_tokens(search, best)
    return answer, best


def _plan_apart(search: Search) -> Candidate | None:
    """Plan goals separately, and also in turn if the number of actions is minimised."""
    if search.task.planner not in _DECOMPOSING:
        return None
    best = plan_goals_apart(search, first_will_do=search.task.objective != "makespan")
    return plan_goals_in_turn(search, best) if best is not None and wants_fewest(search.task) else best


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
            found.append(_plan_whereabouts(search, _plan(search, relax=True)))
            stopped = found[-1].stopped
        except LimitReached as reached:
            if all(result.plan is None for result in found):
                raise
            stopped = reached
        plan = found[-1].plan
        if stopped is not None or (plan is not None and not plan.actions):
            break  # No plan is shorter than the empty plan.
    return choose_best(found, time.monotonic() - began, stopped)
