"""Search for a plan with the facts of one task: all goals at once, apart or in turn, and then with fewer actions."""

from dataclasses import replace

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.plan import Fewest
from hybrid_tamp.symbolic.engines.planner_process import PlannerAnswer
from hybrid_tamp.symbolic.engines.registry import FIRST, SHORTENING
from hybrid_tamp.symbolic.relaxation import may_be_solvable
from hybrid_tamp.symbolic.strategies.fewest import count_facts, judge_fewest, wants_fewest
from hybrid_tamp.symbolic.strategies.goals_apart import plan_goals_apart
from hybrid_tamp.symbolic.strategies.in_turn import plan_goals_in_turn
from hybrid_tamp.symbolic.strategies.needless import drop_needless
from hybrid_tamp.symbolic.strategies.rebinding import rebind, swap_tokens
from hybrid_tamp.symbolic.strategies.results import unsolvable
from hybrid_tamp.symbolic.strategies.search import Candidate, Search, SearchResult

WHOLE = "the whole task at once"

MOST_AT_ONCE = 1000
"""Largest number of possible feasibility facts of a task that is planned at once before its goals are separated."""

STOPPING = (SHORTENING, FIRST, "symk", "enhsp", "pyperplan")
"""Engines that may plan goals separately. They stop if there is no plan, and do not guarantee the fewest actions."""


def plan_with_facts(search: Search, relax: bool) -> SearchResult:
    """Search for a plan with the facts of one task.

    Raises:
        LimitReached: If a limit was reached before any plan was found.
    """
    task, original = search.task, search.original
    answer: PlannerAnswer | None = None
    stopped: LimitReached | None = None
    if relax and not is_within_reach(search):
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


def is_within_reach(search: Search) -> bool:
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
    if search.task.planner not in STOPPING:
        return None
    best = plan_goals_apart(search, first_will_do=search.task.objective != "makespan")
    return plan_goals_in_turn(search, best) if best is not None and wants_fewest(search.task) else best
