"""Results of searches without a plan, and the best result of the alternatives of a goal with a choice."""

from collections.abc import Sequence
from dataclasses import replace

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.engines.planner_process import PlannerAnswer
from hybrid_tamp.symbolic.relaxation import may_be_solvable
from hybrid_tamp.symbolic.strategies.search import Search, SearchResult

REFUSED = "The plans that were found fail in their predicted states: "


def choose_best(found: Sequence[SearchResult], seconds: float, stopped: LimitReached | None) -> SearchResult:
    """Return the best of the results. If several plans are equally good, the first one is returned.

    Args:
        found: Results of the alternatives.
        seconds: Time of all searches [s].
        stopped: Limit that ended the searches before their end, or None.
    """
    solved = [result for result in found if result.plan is not None]
    open_ends = [result for result in found if result.status != "unsolvable"]
    chosen = min(solved, key=lambda each: each.cost) if solved else [*open_ends, *found][0]
    # The duration of a stage is summed over all alternatives.
    stages = {name: sum(result.stages.get(name, 0.0) for result in found) for name in chosen.stages}
    fewest = chosen.fewest
    if fewest == "proven fewest" and not all(each.fewest == fewest or each.status == "unsolvable" for each in found):
        fewest = "no shorter one found"
    answer = replace(chosen.answer, seconds=seconds)
    return replace(chosen, answer=answer, stages=stages, stopped=stopped, fewest=fewest)


def unsolvable(search: Search, task: Task) -> SearchResult:
    """Return the result of a search that proves that a task has no plan."""
    answer = PlannerAnswer("unsolvable", (), search.elapsed, task.planner)
    return SearchResult(answer, None, stages=dict(search.stages), task=task)


def not_found(result: SearchResult, refusals: Sequence[str]) -> SearchResult:
    """Return the result of a search with facts that prove nothing."""
    said = f"{REFUSED}{'; '.join(dict.fromkeys(refusals))}." if refusals else result.answer.message
    answer = replace(result.answer, status="not_found", message=said)
    return replace(result, answer=answer, refusal="")


def is_within_reach(search: Search) -> bool:
    """Return whether the goal can be reached if no fact is ever deleted."""
    with search.stage("compiling"):
        return may_be_solvable(search.compilation.problem)
