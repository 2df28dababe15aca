"""Search for the best lawful plan of a task with all strategies.

Independent goals are planned separately if the engine allows this. If no plan is found, the engine plans the whole task
at once. If the objective is the number of actions, the first lawful plan is returned. If the objective is the
makespan, several numbers of helpers (e.g. hands) per goal are tried. Then interchangeable tokens of the shortest plan
are rebound until the time limit is reached or no rebinding shortens the plan.
"""

import time
from collections.abc import Sequence
from dataclasses import replace

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.engines.planner_process import PlannerAnswer
from hybrid_tamp.symbolic.strategies.goals_apart import plan_goals_apart
from hybrid_tamp.symbolic.strategies.rebinding import rebind_tokens
from hybrid_tamp.symbolic.strategies.search import Candidate, Planner, Search, SearchResult, time_limit_reached

SHORTENING_TIME = 15.0
"""Time limit of the search for shorter plans if the objective is the makespan [s]."""

WHOLE = "the whole task at once"
REBOUND = "interchangeable tokens rebound"

_DECOMPOSING = ("fast-downward", "symk", "enhsp", "pyperplan")
"""Engines that may plan goals separately. They stop if there is no plan, and do not guarantee the fewest actions."""


def find_plan(task: Task, planner: Planner) -> SearchResult:
    """Return a plan that the law checker accepted, or the reason why there is no plan.

    Each action comes from a plan that the validator of unified-planning accepted. If the goal leaves a choice, the
    best plan of all alternatives is returned. The task is proven unsolvable only if every alternative is.

    Args:
        task: Task to plan.
        planner: Running planner process.

    Raises:
        InputError: If the engine is unknown or not installed, or if the goal cannot be compiled.
        LimitReached: If the engine reached its time or memory limit.
    """
    alternatives = task.alternatives()
    if len(alternatives) == 1:
        return _plan_alternative(alternatives[0], planner, SHORTENING_TIME)
    return _plan_alternatives(task, alternatives, planner)


def _plan_alternative(task: Task, planner: Planner, shortening: float) -> SearchResult:
    """Plan a task whose goal leaves no choice. `shortening` is the time limit for finding shorter plans [s]."""
    search = Search(task, planner)
    shortest = task.objective == "makespan"
    best = None
    if task.planner in _DECOMPOSING:
        best = plan_goals_apart(search, shortening, first_will_do=not shortest)
    answer = None
    if best is None:
        with search.stage("compiling"):
            problem = search.compilation.problem
        with search.limits_of_request() as limits:
            answer = planner.solve(problem, task.planner, limits)
        best = search.judge_actions(WHOLE, answer.actions) if answer.status == "solved" else None
    if best is None:
        assert answer is not None, "the engine was not asked for a plan of the whole task"
        refusal = search.refusals[-1] if search.refusals and answer.status == "solved" else ""
        answer = replace(answer, seconds=search.elapsed)
        return SearchResult(answer, None, refusal, stages=dict(search.stages), task=task)
    if shortest and search.elapsed <= shortening:
        best = _rebind(search, best, shortening)
    answer = PlannerAnswer("solved", best.plan.actions, search.elapsed, task.planner, validated=True)
    return SearchResult(answer, best.plan, "", best.way, dict(search.stages), task)


def _rebind(search: Search, best: Candidate, shortening: float) -> Candidate:
    """Rebind interchangeable tokens. Return a shorter lawful plan, or `best` if no shorter plan is found."""
    seconds = shortening - search.elapsed
    with search.stage("scheduling"):
        shorter = rebind_tokens(search.compilation, best.plan, seconds, search.estimates)
    if shorter is best.plan:
        return best
    return search.judge(Candidate(f"{best.way}, {REBOUND}", shorter)) or best


def _plan_alternatives(task: Task, alternatives: Sequence[Task], planner: Planner) -> SearchResult:
    """Return the best result of all alternatives of a goal. The first alternative wins ties."""
    began = time.monotonic()
    found: list[SearchResult] = []
    undecided: list[LimitReached] = []
    for number, each in enumerate(alternatives):
        share = (task.limits.time - (time.monotonic() - began)) / (len(alternatives) - number)
        limited = each.replaced(limits=replace(task.limits, time=max(share, 0.0)))
        try:
            result = _plan_alternative(limited, planner, SHORTENING_TIME / len(alternatives))
        except LimitReached as reached:
            undecided.append(reached)
            continue
        found.append(replace(result, task=each))
        if result.plan is not None and not result.plan.actions:
            break  # No plan is shorter than the empty plan.
    solved = [result for result in found if result.plan is not None]
    if not solved and undecided:
        raise next((each for each in undecided if each.limit != "time"), time_limit_reached(task))
    open_ends = [result for result in found if result.status != "unsolvable"]
    chosen = min(solved, key=_cost) if solved else [*open_ends, *found][0]
    # The duration of a stage is summed over all alternatives.
    stages = {name: sum(result.stages.get(name, 0.0) for result in found) for name in chosen.stages}
    return replace(chosen, answer=replace(chosen.answer, seconds=time.monotonic() - began), stages=stages)


def _cost(result: SearchResult) -> float:
    assert result.plan is not None
    assert result.task is not None
    return result.plan.makespan if result.task.objective == "makespan" else float(len(result.plan.actions))
