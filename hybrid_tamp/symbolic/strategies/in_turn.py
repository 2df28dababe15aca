"""Strategy that plans goals in turn, each from the state in which the plan of the previous goals ends.

Goals planned separately do not share helpers. If few groups of goals have many helpers, more helpers per group may give
fewer actions, e.g. four hands tumble a box with fewer actions than two hands. So each group gets as many helpers as it
can use, also those that served another group before.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from hybrid_tamp.model.facts import facts
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.encoding.problem import Compilation, compile_task
from hybrid_tamp.symbolic.pddl.operators import Fact, PlanningProblem
from hybrid_tamp.symbolic.strategies.groups import Group, Helpers, goal_groups, most_helpers, own_task
from hybrid_tamp.symbolic.strategies.search import Candidate, Search

IN_TURN = "goals planned in turn"

MOST_GROUPS = 3
"""Largest number of groups that are planned in turn. Each group is one more request to the engine."""


def plan_goals_in_turn(search: Search, best: Candidate) -> Candidate:
    """Return a lawful plan with fewer actions than the best plan, or the best plan.

    Args:
        search: Search for a plan of the whole task.
        best: Plan of the whole task.

    Raises:
        LimitReached: If a limit is reached.
    """
    with search.stage("compiling"):
        holding = facts(search.task)
        groups = goal_groups(search.task, holding)
    if not 1 < len(groups) <= MOST_GROUPS:
        return best
    actions: list[PlannedAction] = []
    for group in groups:
        with search.stage("compiling"):
            problem = _pose(search, group, list(_helpers(search, group)), actions)
        with search.limits_of_request() as limits:
            answer = search.planner.solve(problem, search.task.planner, limits)
        actions += answer.actions
        if answer.status != "solved" or len(actions) >= len(best.plan.actions):
            return best
    if not search.compilation.reaches_goal(actions):
        return best
    return search.judge_actions(IN_TURN, actions) or best


def _helpers(search: Search, group: Group) -> Iterator[str]:
    """Yield the helpers of a group, closest first."""
    task, feasible = search.task, search.compilation.feasible
    closest = Helpers(task, group, facts(task), feasible, search.deadline).closest
    yield from closest[: most_helpers(task)]


def _pose(search: Search, group: Group, chosen: Sequence[str], before: Sequence[PlannedAction]) -> PlanningProblem:
    """Return the planning problem of a group after the actions of the groups before."""
    whole = search.compilation
    part = compile_task(_own_task(search.task, group, chosen), whole)
    known = {name for name, _ in (*part.problem.objects, *part.problem.domain.constants)}
    changed = {fact for fact in _advance(whole, before) if known.issuperset(fact[1:])}
    return replace(part.problem, init=tuple(sorted({*part.problem.init} - part.changing | changed)))


def _own_task(task: Task, group: Group, chosen: Sequence[str]) -> Task:
    return own_task(task, group, chosen, [token.name for token in task.tokens if token.place])


def _advance(whole: Compilation, actions: Sequence[PlannedAction]) -> set[Fact]:
    """Return the changing facts that hold after the actions."""
    operators = {operator.name: operator for operator in whole.encoded.planning.operators}
    known = set(whole.changing)
    for action in actions:
        known = operators[action.name].effects(operators[action.name].bind(action), known)
    return known
