"""Proof that a plan has the fewest actions that any plan of its task can have.

An engine proves this for its own planning problem, which contains the feasibility facts of the initial state. Movements
may make other facts true. So a proof also needs a problem in which every fact holds that may hold anywhere
(`whereabouts.relax`). If each plan of this problem has at least as many actions, so has each plan of the task.
"""

from math import prod

from hybrid_tamp.model.plan import Fewest
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerAnswer
from hybrid_tamp.symbolic.engines.registry import ENGINES, SHORTENING
from hybrid_tamp.symbolic.strategies.search import Candidate, Search
from hybrid_tamp.symbolic.whereabouts.relax import relax_task
from hybrid_tamp.symbolic.whereabouts.tracking import Tracking

MOST_FACTS = 100
"""Largest number of possible facts for which the second problem is planned, unless the user chose an optimal engine."""


def wants_fewest(task: Task) -> bool:
    """Return whether the strategies look for plans with fewer actions."""
    return task.planner == SHORTENING and task.objective != "makespan"


def count_facts(task: Task) -> int:
    """Return the number of possible feasibility facts of a task, without relations over symbols."""
    predicates = [each for each in task.domain.static_predicates if each.rows is None]
    return sum(prod(len(task.values_of(each.sort)) for each in predicate.parameters) for predicate in predicates)


def judge_fewest(search: Search, answer: PlannerAnswer | None, best: Candidate) -> Fewest:
    """Return what is known about the number of actions in the best plan.

    Plans of separate goals prove nothing, because each goal is planned with some of the tokens only.

    Args:
        search: Search for a plan of the whole task.
        answer: Answer of the engine for the whole task, or None if the engine was not asked.
        best: Best lawful plan.

    Raises:
        LimitReached: If a limit is reached.
    """
    if answer is None or answer.actions != tuple(best.plan.actions):
        return "no shorter one found" if wants_fewest(search.task) else "first found"
    if answer.fewest != "proven fewest" or _is_bound(search, answer):
        return answer.fewest
    return "no shorter one found"


def _is_bound(search: Search, answer: PlannerAnswer) -> bool:
    """Return whether no plan of the task has fewer actions than the optimal plan of the engine's problem."""
    task = search.task
    tracking = Tracking(task.domain)
    if task is not search.original:
        return False
    if not tracking.parameters:
        return True
    optimal = task.planner in ENGINES and ENGINES[task.planner].optimal
    if count_facts(task) > MOST_FACTS and not optimal:
        return False
    with search.stage("compiling"):
        relaxed = compile_task(relax_task(task, tracking)).problem
    given = search.compilation.problem
    if (relaxed.init, relaxed.domain.operators) == (given.init, given.domain.operators):
        return True
    with search.limits_of_request() as limits:
        bound = search.planner.solve(relaxed, SHORTENING, limits)
    return bound.status == "solved" and bound.fewest == "proven fewest" and len(bound.actions) >= len(answer.actions)
