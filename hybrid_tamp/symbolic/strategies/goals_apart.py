"""Strategy that plans independent goals separately and merges the plans.

Goals that share tokens form a group. Several numbers of helpers (e.g. hands) per group are tried. The plans of two
groups share only places and helpers that have returned to their initial state. The concatenated plan is checked action
by action. The schedule runs independent plans in parallel.

Two groups share a plan if their planning problems are equal up to renaming. So any number of equal boxes, each with
equally placed hands, needs only one search.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice, permutations, product

from hybrid_tamp.model.facts import facts
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.decode import NotAPlanError
from hybrid_tamp.symbolic.encoding.problem import Compilation, compile_task
from hybrid_tamp.symbolic.pddl.operators import Fact, PlanningProblem, ground, rename_arguments
from hybrid_tamp.symbolic.schedule import schedule_actions
from hybrid_tamp.symbolic.strategies.allocation import Allocation, Demand, Share
from hybrid_tamp.symbolic.strategies.groups import goal_groups, helpers, least_helpers, most_helpers, own_task
from hybrid_tamp.symbolic.strategies.search import Candidate, Search

APART = "goals planned separately"

_ORDERS = 24
"""Largest number of orders of equal helpers to try for a group."""
_MOST_PROBLEMS = 16
"""Number of planning problems of groups after which no further number of helpers is tried once there is a plan."""

Key = tuple[frozenset[Fact], frozenset[Fact], tuple[tuple[str, str], ...]]
Actions = tuple[PlannedAction, ...]


def plan_goals_apart(search: Search, *, first_will_do: bool) -> Candidate | None:
    """Return the plan with the smallest makespan over different numbers of helpers per group, or None.

    Numbers of helpers that all groups can have at once are tried first, starting with the largest. If no plan is
    found, larger numbers are tried, and helpers serve the groups one after another.

    Args:
        search: Search for a plan of the whole task.
        first_will_do: Whether to return the first plan. If True, nothing is planned unless a group is smaller than the
            task.

    Raises:
        LimitReached: If a limit is reached. A group whose planning takes long does not count as a group without a plan.
    """
    best: Candidate | None = None
    with search.stage("compiling"):
        groups = _Groups(search)
        if first_will_do and not groups.smaller_than_the_task:
            return None
        at_once, least, most = groups.count_helpers()
        for count in (*range(at_once, least - 1, -1), *range(at_once + 1, most + 1)):
            if groups.hopeless or (best is not None and count > at_once):
                break
            demands = groups.find_demands(count)
            actions = None if demands is None else groups.find_actions(demands, any_order=not first_will_do)
            if actions is None:
                continue
            found = search.judge_actions(f"{APART}, with {count} helpers per group", actions)
            if found is not None and (best is None or found.plan.makespan < best.plan.makespan - 1e-6):
                best = found
            if found is not None and (first_will_do or groups.problems >= _MOST_PROBLEMS):
                break
    return best


class _Groups:
    """The groups of a task's goals, with the known plans.

    Attributes:
        allocation: Allocation of helpers to groups.
        hopeless: Whether some group has no plan even with all useful helpers.
        problems: Number of planning problems that were given to the engine.
    """

    def __init__(self, search: Search) -> None:
        self._search = search
        self._task = search.task
        self._holding = facts(search.task)
        self._groups = goal_groups(search.task, self._holding)
        self._places = tuple(token.name for token in search.task.tokens if token.place)
        self._known: dict[Key, Actions | None] = {}
        feasible = search.compilation.feasible
        self.allocation = Allocation(search.task, self._groups, self._holding, feasible, search.deadline)
        self.hopeless = False
        self.problems = 0

    @property
    def smaller_than_the_task(self) -> bool:
        """Whether a group is a smaller problem than the whole task."""
        left_out = len(self._task.assigned) - sum(len(group.tokens) for group in self._groups)
        return len(self._groups) > 1 or (len(self._groups) == 1 and left_out > most_helpers(self._task))

    def count_helpers(self) -> tuple[int, int, int]:
        """Return numbers of helpers per group: the number that all groups can have at once, minimum, maximum."""
        available = len(helpers(self._task))
        least = max((least_helpers(self._task, group, self._holding) for group in self._groups), default=1)
        if not self._groups or least > available:
            return 0, 1, 0
        most = min(available, max(least, most_helpers(self._task)))
        return min(most, max(least, available // len(self._groups))), least, most

    def find_demands(self, count: int) -> list[Demand] | None:
        """Return a demand for each group, for the closest helpers that suffice. Return None if a group has no plan."""
        demands: list[Demand] = []
        for group in self._groups:
            for chosen in self.allocation.choices(group, count):
                if self.plan_group(Share(group, chosen)) is not None:
                    demands.append(self.allocation.demand(group, chosen))
                    break
            else:
                # A group that has no plan with all useful helpers has no plan with fewer helpers.
                together = self.allocation.considered(group, most_helpers(self._task))
                self.hopeless = self.plan_group(Share(group, together)) is None
                return None
        return demands

    def find_actions(self, demands: Sequence[Demand], *, any_order: bool) -> Actions | None:
        """Return the actions of the plan of all groups, or None if there is no such plan.

        Args:
            demands: Demands of the groups.
            any_order: Whether to choose the order of the groups with the smallest makespan, if some have to wait.
        """
        orders = islice(self.allocation.shares_in_orders(demands), None if any_order else 1)
        plans = [tuple(merged) for waves in orders if (merged := self.merge_plans(waves)) is not None]
        return self._shortest(plans) if plans else None

    def _shortest(self, plans: Sequence[Actions]) -> Actions:
        """Return the first of the plans with the smallest makespan."""
        return plans[0] if len(plans) == 1 else min(plans, key=self._makespan)

    def merge_plans(self, waves: Sequence[Sequence[Share]]) -> list[PlannedAction] | None:
        """Concatenate the best plan of each share. Return None if the result is not a plan of the whole task."""
        merged: list[PlannedAction] = []
        self._search.waits = len(waves) > 1
        for share in (share for wave in waves for share in wave):
            plans = [plan for order in self._orders(share) if (plan := self.plan_group(order)) is not None]
            if not plans:
                return None
            merged += self._shortest(plans)
        with self._search.stage("scheduling"):
            return merged if self._search.compilation.reaches_goal(merged) else None

    def _orders(self, share: Share) -> list[Share]:
        """Return the orders of a share's helpers to try. For the makespan, helpers of one kind are permuted."""
        if self._task.objective != "makespan":
            return [share]
        kinds = self.allocation.demand(share.group, share.helpers).kinds
        alike = [[h for h, k in zip(share.helpers, kinds, strict=True) if k == kind] for kind in dict.fromkeys(kinds)]
        orders = islice(product(*map(permutations, alike)), _ORDERS)
        return [replace(share, helpers=tuple(name for some in order for name in some)) for order in orders]

    def _makespan(self, actions: Actions) -> float:
        """Return the makespan of a plan [s], or infinity if the plan cannot be scheduled."""
        compilation = self._search.compilation
        try:
            with self._search.stage("scheduling"):
                return schedule_actions(compilation, actions, self._search.estimates).makespan
        except NotAPlanError:
            return float("inf")

    def plan_group(self, share: Share) -> Actions | None:
        """Return the actions of a group with the PDDL names of the whole task, or None if no plan is found."""
        search, own = self._search, share.group.places
        # The group is planned with the places in its goal. If this gives no plan, it is planned with all places.
        for places in (own, self._places) if len(own) < len(self._places) else (own,):
            posed = self._pose(share, places)
            if posed.key not in self._known:
                self.problems += 1
                with search.limits_of_request() as limits:
                    answer = search.planner.solve(posed.problem, search.engine, limits)
                self._known[posed.key] = posed.generalise(answer.actions) if answer.status == "solved" else None
            found = self._known[posed.key]
            if found is not None:
                return posed.specialise(found)
        return None

    def _pose(self, share: Share, places: Sequence[str]) -> "_Posed":
        """Return the planning problem of a group with the given helpers and places."""
        whole = self._search.compilation
        self._search.deadline.check()
        with self._search.stage("compiling"):
            part = compile_task(own_task(self._task, share.group, share.helpers, places), whole)
            wanted = (*part.goal, *(_at_start(part, share.helpers) if share.returning else ()))
            order = (*share.group.tokens, *dict.fromkeys((*share.group.places, *places)), *share.helpers)
            # Equal groups have their tokens in the same order, so they get the same labels.
            labels = {part.words.name(name): f"#{index}" for index, name in enumerate(order)}
            names = {f"#{index}": whole.words.name(name) for index, name in enumerate(order)}
            return _Posed(replace(part.problem, goal=tuple(sorted(set(wanted)))), labels, names)


@dataclass(frozen=True)
class _Posed:
    """The planning problem of a group, with a label for each object. `names` maps labels to names in the whole task."""

    problem: PlanningProblem
    labels: Mapping[str, str]
    names: Mapping[str, str]

    @cached_property
    def key(self) -> Key:
        """The problem with labels in place of objects."""
        objects = tuple(sorted((self.labels.get(name, name), kind) for name, kind in self.problem.objects))
        init, goal = (
            frozenset(ground(fact, self.labels) for fact in some) for some in (self.problem.init, self.problem.goal)
        )
        return init, goal, objects

    def generalise(self, actions: Sequence[PlannedAction]) -> Actions:
        """Replace the objects in actions of the problem by labels."""
        return tuple(rename_arguments(action, self.labels) for action in actions)

    def specialise(self, actions: Sequence[PlannedAction]) -> Actions:
        """Replace the labels in actions by objects of the whole task."""
        return tuple(rename_arguments(action, self.names) for action in actions)


def _at_start(part: Compilation, names_of_helpers: Sequence[str]) -> Iterator[Fact]:
    """Yield the initial facts that mention a helper and that an operator may change."""
    changed = {fact[0] for operator in part.encoded.planning.operators for fact in (*operator.add, *operator.delete)}
    names = {part.words.name(helper) for helper in names_of_helpers}
    yield from (fact for fact in part.changing if fact[0] in changed and names & set(fact[1:]))
