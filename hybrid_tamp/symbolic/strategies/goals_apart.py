"""Independent goals planned apart and merged: a strategy for plans of many goals.

Each group of goals that share tokens is planned by itself, with different numbers of helpers. The plans are
concatenated. They share only places and helpers that have returned to their initial state, so they stay applicable;
this is checked action by action. The schedule runs independent plans at the same time.

Two groups have the same plan if renaming their tokens turns one planning problem into the other. So any number of
equal boxes with equally placed hands needs one search.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice, permutations, product

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.facts import facts
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.decode import NotAPlanError
from hybrid_tamp.symbolic.encoding.problem import Compilation, compile_task
from hybrid_tamp.symbolic.pddl.operators import Fact, PlanningProblem, ground, rename_arguments
from hybrid_tamp.symbolic.schedule import schedule_actions
from hybrid_tamp.symbolic.strategies.allocation import Allocation, Demand, Share
from hybrid_tamp.symbolic.strategies.groups import goal_groups, helpers, least_helpers, most_helpers, own_task
from hybrid_tamp.symbolic.strategies.search import Candidate, Search

APART = "goals planned apart"

_ORDERS = 24
"""Largest number of orders of equal helpers that are tried for a group."""

Key = tuple[frozenset[Fact], frozenset[Fact], tuple[tuple[str, str], ...]]
Actions = tuple[PlannedAction, ...]


def plan_goals_apart(search: Search, seconds: float, *, first_will_do: bool) -> Candidate | None:
    """Return the plan with the smallest makespan over different numbers of helpers per group, or None.

    The first number is the largest with which all groups have helpers at once; then come smaller numbers. With a larger
    number, helpers serve the groups one after the other; it is tried only if there is no plan yet.

    Args:
        search: the search for a plan of the whole task.
        seconds: time limit for one group, and for the search for shorter plans [s].
        first_will_do: whether to return the first plan, and to search only if a group is smaller than the task.
    """
    best: Candidate | None = None
    with search.stage("compiling"):
        groups = _Groups(search, seconds)
        if first_will_do and not groups.smaller_than_the_task:
            return None
        at_once, least, most = groups.count_helpers()
        for count in (*range(at_once, least - 1, -1), *range(at_once + 1, most + 1)):
            if groups.hopeless or (best is not None and count > at_once):
                break
            demands = groups.find_demands(count)
            waves = None if demands is None else groups.allocation.shares(demands)
            actions = None if waves is None else groups.merge_plans(waves)
            if actions is None:
                continue
            found = search.judge_actions(f"{APART}, each with {count} tokens to help", actions)
            if found is not None and (best is None or found.plan.makespan < best.plan.makespan - 1e-6):
                best = found
            if found is not None and (first_will_do or search.elapsed > seconds):
                break
    return best


class _Groups:
    """The groups of the goals of a task, with the plans that are known so far.

    Attributes:
        allocation: assigns helpers to groups.
        hopeless: whether some group has no plan even with all useful helpers.
    """

    def __init__(self, search: Search, seconds: float) -> None:
        self._search = search
        self._task = search.task
        self._seconds = seconds
        self._holding = facts(search.task)
        self._groups = goal_groups(search.task, self._holding)
        self._places = tuple(token.name for token in search.task.tokens if token.place)
        self._known: dict[Key, Actions | None] = {}
        self.allocation = Allocation(search.task, self._groups, self._holding, search.compilation.feasible)
        self.hopeless = False

    @property
    def smaller_than_the_task(self) -> bool:
        """Whether a group is a smaller problem than the whole task."""
        left_out = len(self._task.assigned) - sum(len(group.tokens) for group in self._groups)
        return len(self._groups) > 1 or (len(self._groups) == 1 and left_out > most_helpers(self._task))

    def count_helpers(self) -> tuple[int, int, int]:
        """Return the numbers of helpers per group: available to all groups at once, least and most that are useful."""
        available = len(helpers(self._task))
        least = max((least_helpers(self._task, group, self._holding) for group in self._groups), default=1)
        if not self._groups or least > available:
            return 0, 1, 0
        most = min(available, max(least, most_helpers(self._task)))
        return min(most, max(least, available // len(self._groups))), least, most

    def find_demands(self, count: int) -> list[Demand] | None:
        """Return the demand of each group, for the closest helpers with which it has a plan; None if one has none."""
        demands: list[Demand] = []
        for group in self._groups:
            for chosen in self.allocation.choices(group, count):
                if self.plan_group(Share(group, chosen)) is not None:
                    demands.append(self.allocation.demand(group, chosen))
                    break
            else:
                # If the group has no plan with all of them together, it has none with fewer.
                together = self.allocation.considered(group, most_helpers(self._task))
                self.hopeless = self.plan_group(Share(group, together)) is None
                return None
        return demands

    def merge_plans(self, waves: Sequence[Sequence[Share]]) -> list[PlannedAction] | None:
        """Return the plans of all shares, one after the other, or None if that is not a plan of the whole task.

        If the objective is the makespan, helpers of one kind take the order that gives the shortest plan.
        """
        merged: list[PlannedAction] = []
        for share in (share for wave in waves for share in wave):
            orders = self._orders(share)
            plans: list[tuple[float, Actions]] = []
            for order in orders:
                found = self.plan_group(order)
                if found is not None:
                    plans.append((self._makespan(found) if len(orders) > 1 else 0.0, found))
            if not plans:
                return None
            merged += min(plans, key=lambda plan: plan[0])[1]
        with self._search.stage("scheduling"):
            return merged if self._search.compilation.reaches_goal(merged) else None

    def _orders(self, share: Share) -> list[Share]:
        """Return the share with different orders of helpers of one kind if the objective is the makespan."""
        if self._task.objective != "makespan":
            return [share]
        kinds = self.allocation.demand(share.group, share.helpers).kinds
        alike = [[h for h, k in zip(share.helpers, kinds, strict=True) if k == kind] for kind in dict.fromkeys(kinds)]
        orders = islice(product(*map(permutations, alike)), _ORDERS)
        return [replace(share, helpers=tuple(name for some in order for name in some)) for order in orders]

    def _makespan(self, actions: Actions) -> float:
        """Return the makespan of the plan of one group alone [s]."""
        compilation = self._search.compilation
        try:
            with self._search.stage("scheduling"):
                return schedule_actions(compilation, actions, self._search.estimates).makespan
        except NotAPlanError:
            return float("inf")

    def plan_group(self, share: Share) -> Actions | None:
        """Return the actions of a group, in the words of the whole task, or None if it has no plan.

        The plan is first sought with the places that the goal of the group names, then with all places.
        """
        search, own = self._search, share.group.places
        for places in (own, self._places) if len(own) < len(self._places) else (own,):
            posed = self._pose(share, places)
            if posed.key not in self._known:
                self._known[posed.key] = None  # If it is not found in time, the whole task can still be planned.
                with suppress(LimitReached), search.limits_of_request(self._seconds) as limits:
                    answer = search.planner.solve(posed.problem, search.task.planner, limits)
                    if answer.status == "solved":
                        self._known[posed.key] = posed.generalise(answer.actions)
            found = self._known[posed.key]
            if found is not None:
                return posed.specialise(found)
        return None

    def _pose(self, share: Share, places: Sequence[str]) -> "_Posed":
        """Return the planning problem of a group with some places."""
        whole = self._search.compilation
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
    """The planning problem of a group, with labels for its objects that are the same for equal groups.

    Attributes:
        problem: the problem.
        labels: PDDL name in it to label.
        names: label to PDDL name in the whole task.
    """

    problem: PlanningProblem
    labels: Mapping[str, str]
    names: Mapping[str, str]

    @cached_property
    def key(self) -> Key:
        """The problem up to renaming."""
        objects = tuple(sorted((self.labels.get(name, name), kind) for name, kind in self.problem.objects))
        init, goal = (
            frozenset(ground(fact, self.labels) for fact in some) for some in (self.problem.init, self.problem.goal)
        )
        return init, goal, objects

    def generalise(self, actions: Sequence[PlannedAction]) -> Actions:
        """Return actions of the problem with labels in place of objects."""
        return tuple(rename_arguments(action, self.labels) for action in actions)

    def specialise(self, actions: Sequence[PlannedAction]) -> Actions:
        """Return actions with labels as actions of the whole task."""
        return tuple(rename_arguments(action, self.names) for action in actions)


def _at_start(part: Compilation, names_of_helpers: Sequence[str]) -> Iterator[Fact]:
    """Yield the initial facts about the helpers that some action can change."""
    changed = {fact[0] for operator in part.encoded.planning.operators for fact in (*operator.add, *operator.delete)}
    names = {part.words.name(helper) for helper in names_of_helpers}
    yield from (fact for fact in part.changing if fact[0] in changed and names & set(fact[1:]))
