"""Search for the best lawful plan of a task with all strategies.

Independent goals are planned separately. If this gives no plan, the engine plans the whole task at once. To find the
fewest actions, a small task is first planned at once, and few groups of goals are also planned in turn. Needless
actions are dropped. For the makespan, goals are planned separately with different numbers of helpers, and
interchangeable tokens are rebound until no rebinding shortens the plan. Counts limit these searches. The deadline of
the command ends them, but shapes no plan.
"""

import time
from collections.abc import Sequence
from dataclasses import replace

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.expectation import Expectations
from hybrid_tamp.model.plan import Fewest
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.engines.planner_process import PlannerAnswer
from hybrid_tamp.symbolic.engines.registry import FIRST, SHORTENING
from hybrid_tamp.symbolic.preferences import begin_with_preferences, complete
from hybrid_tamp.symbolic.strategies.fewest import count_facts, judge_fewest, wants_fewest
from hybrid_tamp.symbolic.strategies.goals_apart import plan_goals_apart
from hybrid_tamp.symbolic.strategies.in_turn import plan_goals_in_turn
from hybrid_tamp.symbolic.strategies.needless import drop_needless
from hybrid_tamp.symbolic.strategies.rebinding import rebind, swap_tokens
from hybrid_tamp.symbolic.strategies.results import choose_best, is_within_reach, unsolvable
from hybrid_tamp.symbolic.strategies.search import Candidate, Planner, Search, SearchResult

WHOLE = "the whole task at once"

MOST_AT_ONCE = 1000
"""Largest number of possible feasibility facts of a task that is planned at once before its goals are separated."""

STOPPING = (SHORTENING, FIRST, "symk", "enhsp", "pyperplan")
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
        first = begin_with_preferences(search)
        return complete(search, first, plan_with_facts(first, relax), relax, plan_with_facts)
    return _plan_alternatives(alternatives, planner, deadline, expectations)


def plan_with_facts(search: Search, relax: bool) -> SearchResult:
    """Search for a plan with the facts of one task.

    Raises:
        LimitReached: If a limit was reached before any plan was found.
    """
    task, original = search.task, search.original
    answer: PlannerAnswer | None = None
    stopped: LimitReached | None = None
    if (relax or task.planner not in STOPPING) and not is_within_reach(search):
        return unsolvable(search, original)
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
    if search.task.planner not in STOPPING:
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
            first = begin_with_preferences(search)
            found.append(complete(search, first, plan_with_facts(first, relax=True), True, plan_with_facts))
            stopped = found[-1].stopped
        except LimitReached as reached:
            if all(result.plan is None for result in found):
                raise
            stopped = reached
        plan = found[-1].plan
        if stopped is not None or (plan is not None and not plan.actions):
            break  # No plan is shorter than the empty plan.
    return choose_best(found, time.monotonic() - began, stopped)
