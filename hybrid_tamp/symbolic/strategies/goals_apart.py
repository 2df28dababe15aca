"""Independent goals planned apart and merged: a strategy for a plan of many goals.

Each group of goals that share tokens is planned by itself, with as few helpers or as many as are of use. The plans
are put one after the other; as they share no tokens but places and helpers that have come back to where they were,
they stay applicable, which is checked action by action. In time, what is independent runs at once.

Two groups have the same plan if renaming their tokens makes one planning problem of the other. So equal boxes with
hands placed alike need one search, whatever their number.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice, permutations, product

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.facts import facts
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.decode import UndecodableError, decode
from hybrid_tamp.symbolic.encoding.problem import Compilation, compile_task
from hybrid_tamp.symbolic.pddl.operators import Fact, PlanningProblem, ground, rename_arguments
from hybrid_tamp.symbolic.schedule import InfeasibleScheduleError, schedule
from hybrid_tamp.symbolic.strategies.allocation import Allocation, Demand, Share
from hybrid_tamp.symbolic.strategies.groups import goal_groups, helpers, least_helpers, most_helpers, own_task
from hybrid_tamp.symbolic.strategies.search import Candidate, Search

APART = "goals planned apart"

_ORDERS = 24
"""So many orders of equal helpers are tried for a group."""

Key = tuple[frozenset[Fact], frozenset[Fact], tuple[tuple[str, str], ...]]
Actions = tuple[PlannedAction, ...]


def plan_goals_apart(search: Search, seconds: float, *, first_will_do: bool) -> Candidate | None:
    """Return the plan with the least makespan of those with different numbers of helpers for a group, or None.

    First come as many helpers as there are for all groups at once, then fewer. More would have to serve one group
    after the other, and are tried only where these do not do.

    Args:
        search: the search for a plan of the whole task.
        seconds: how long the planner may take for one group, and when to stop looking for shorter plans [s].
        first_will_do: whether the first plan will do, and is worth the effort only if groups are smaller than the task.
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
    """The groups of a task's goals, with their plans as far as they are known.

    Attributes:
        allocation: gives helpers to groups.
        hopeless: whether some group has no plan even with all helpers that are of use.
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
        """Return how many helpers a group can have at once with all others, and the least and the most of use."""
        available = len(helpers(self._task))
        least = max((least_helpers(self._task, group, self._holding) for group in self._groups), default=1)
        if not self._groups or least > available:
            return 0, 1, 0
        most = min(available, max(least, most_helpers(self._task)))
        return min(most, max(least, available // len(self._groups))), least, most

    def find_demands(self, count: int) -> list[Demand] | None:
        """Return for each group the closest helpers with whose like its goal can be reached; None if one has none."""
        demands: list[Demand] = []
        for group in self._groups:
            for chosen in self.allocation.choices(group, count):
                if self.plan_group(Share(group, chosen)) is not None:
                    demands.append(self.allocation.demand(group, chosen))
                    break
            else:
                # What all of them together cannot do, none of them can: then every further try would be in vain.
                together = self.allocation.considered(group, most_helpers(self._task))
                self.hopeless = self.plan_group(Share(group, together)) is None
                return None
        return demands

    def merge_plans(self, waves: Sequence[Sequence[Share]]) -> list[PlannedAction] | None:
        """Return the plans of all shares, one after the other, or None if that is no plan of the whole task.

        Where the makespan counts, helpers of one kind serve in the order that gives the shortest plan.
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
        """Return the share with helpers of one kind in every order, up to a limit, if the makespan counts."""
        if self._task.objective != "makespan":
            return [share]
        kinds = self.allocation.demand(share.group, share.helpers).kinds
        alike = [[h for h, k in zip(share.helpers, kinds, strict=True) if k == kind] for kind in dict.fromkeys(kinds)]
        orders = islice(product(*map(permutations, alike)), _ORDERS)
        return [replace(share, helpers=tuple(name for some in order for name in some)) for order in orders]

    def _makespan(self, actions: Actions) -> float:
        """Return how long a group takes by itself [s]."""
        compilation = self._search.compilation
        try:
            with self._search.stage("scheduling"):
                return schedule(self._task, decode(compilation, actions), (), self._search.estimates).makespan
        except (UndecodableError, InfeasibleScheduleError):
            return float("inf")

    def plan_group(self, share: Share) -> Actions | None:
        """Return a group's actions, in the words of the whole task, or None if it has no plan.

        Its plan has the places that its goal names, or else all.
        """
        search, own = self._search, share.group.places
        for places in (own, self._places) if len(own) < len(self._places) else (own,):
            posed = self._pose(share, places)
            if posed.key not in self._known:
                self._known[posed.key] = None  # It may not be found in time; the whole task is still there.
                with suppress(LimitReached), search.limits_of_request(self._seconds) as limits:
                    answer = search.planner.solve(posed.problem, search.task.planner, limits)
                    if answer.status == "solved":
                        self._known[posed.key] = posed.generalise(answer.actions)
            found = self._known[posed.key]
            if found is not None:
                return posed.specialise(found)
        return None

    def _pose(self, share: Share, places: Sequence[str]) -> "_Posed":
        """Return the planning problem of a group, with these places."""
        whole = self._search.compilation
        with self._search.stage("compiling"):
            part = compile_task(own_task(self._task, share.group, share.helpers, places), whole)
            wanted = (*part.goal, *(_at_start(part, share.helpers) if share.returning else ()))
            order = (*share.group.tokens, *dict.fromkeys((*share.group.places, *places)), *share.helpers)
            # Equal groups have their tokens in the same order.
            labels = {part.name(name): f"#{index}" for index, name in enumerate(order)}
            names = {f"#{index}": whole.name(name) for index, name in enumerate(order)}
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
        """Return actions of the problem with labels for objects."""
        return tuple(rename_arguments(action, self.labels) for action in actions)

    def specialise(self, actions: Sequence[PlannedAction]) -> Actions:
        """Return actions with labels in the words of the whole task."""
        return tuple(rename_arguments(action, self.names) for action in actions)


def _at_start(part: Compilation, names_of_helpers: Sequence[str]) -> Iterator[Fact]:
    """Yield the initial facts about the helpers that some action can change."""
    changed = {fact[0] for operator in part.encoded.planning.operators for fact in (*operator.add, *operator.delete)}
    names = {part.name(helper) for helper in names_of_helpers}
    yield from (fact for fact in part.changing if fact[0] in changed and names & set(fact[1:]))
