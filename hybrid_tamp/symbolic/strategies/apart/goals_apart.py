"""Planning independent goals apart and merging: one of the ways to a plan.

Each group of goals that share tokens is planned by itself, with as few helpers or as many as are of use. The plans
are put one after the other; as they share no tokens but places and helpers that have come back to where they were,
they stay applicable, which is checked action by action. In time, what is independent runs at once.
"""

from collections.abc import Iterator, Sequence
from itertools import islice, permutations, product

from hybrid_tamp.model.facts import facts
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.symbolic.decode import UndecodableError, decode
from hybrid_tamp.symbolic.encoding.application import applicable
from hybrid_tamp.symbolic.schedule import InfeasibleScheduleError, schedule
from hybrid_tamp.symbolic.strategies.apart.allocation import Allocation, Demand, Share
from hybrid_tamp.symbolic.strategies.apart.groups import Group, goal_groups, helpers, least_helpers, most_helpers
from hybrid_tamp.symbolic.strategies.apart.templates import Templates
from hybrid_tamp.symbolic.strategies.search import Candidate, Search

APART = "goals planned apart"

_ORDERS = 24
"""So many orders of equal helpers are tried for a group."""


class GoalsApart:
    """Plans the groups of a task's goals apart."""

    def __init__(self, search: Search, seconds: float) -> None:
        """Prepare.

        Args:
            search: the search for a plan of the whole task.
            seconds: how long the planner may take for one group [s].
        """
        self._search = search
        self._task = search.task
        self._holding = facts(search.task)
        self._groups = goal_groups(search.task, self._holding)
        self._allocation = Allocation(search.task, self._groups, self._holding, search.compilation.feasible)
        self._templates = Templates(search, seconds)
        self._hopeless = False
        self._places = [token.name for token in search.task.tokens if token.place]

    @property
    def worthwhile(self) -> bool:
        """Whether the parts are smaller than the whole."""
        left_out = len(self._task.assigned) - sum(len(group.tokens) for group in self._groups)
        return len(self._groups) > 1 or (len(self._groups) == 1 and left_out > most_helpers(self._task))

    def candidates(self) -> Iterator[Candidate]:
        """Yield lawful plans with different numbers of helpers for a group.

        First come as many as there are for all groups at once, then fewer. More would have to serve one group after
        the other, and are tried only where these do not do.
        """
        at_once, least, most = self._counts()
        found = False
        for count in (*range(at_once, least - 1, -1), *range(at_once + 1, most + 1)):
            if self._hopeless or (found and count > at_once):
                return
            for candidate in self._with(count):
                found = True
                yield candidate

    def _counts(self) -> tuple[int, int, int]:
        """Return how many helpers a group can have at once with all others, and the least and the most of use."""
        available = len(helpers(self._task))
        least = max((least_helpers(self._task, group, self._holding) for group in self._groups), default=1)
        if not self._groups or least > available:
            return 0, 1, 0
        most = min(available, max(least, most_helpers(self._task)))
        return min(most, max(least, available // len(self._groups))), least, most

    def _with(self, count: int) -> Iterator[Candidate]:
        """Yield the plan with so many helpers for each group, if there is one."""
        demands = self._demands(count)
        waves = None if demands is None else self._allocation.shares(demands)
        actions = None if waves is None else self._merged(waves)
        if actions is not None:
            found = self._search.candidate(f"{APART}, each with {count} tokens to help", actions)
            if found is not None:
                yield found

    def _demands(self, count: int) -> list[Demand] | None:
        demands: list[Demand] = []
        for group in self._groups:
            demand = self._demand(group, count)
            if demand is None:
                # What all of them together cannot do, none of them can: then every further try would be in vain.
                together = self._allocation.considered(group, most_helpers(self._task))
                self._hopeless = self._plan(Share(group, together)) is None
                return None
            demands.append(demand)
        return demands

    def _demand(self, group: Group, count: int) -> Demand | None:
        """Return the closest helpers with whose like the group's goal can be reached, as a demand."""
        for chosen in self._allocation.choices(group, count):
            if self._plan(Share(group, chosen)) is not None:
                return self._allocation.demand(group, chosen)
        return None

    def _plan(self, share: Share) -> tuple[PlannedAction, ...] | None:
        """Return a group's plan: with the places that its goal names, or else with all."""
        found = self._templates.plan(share.group, share.helpers, share.group.places, returning=share.returning)
        if found is None and len(share.group.places) < len(self._places):
            found = self._templates.plan(share.group, share.helpers, self._places, returning=share.returning)
        return found

    def _merged(self, waves: Sequence[Sequence[Share]]) -> list[PlannedAction] | None:
        """Return the plans of all shares, one after the other, or None if that is no plan of the whole task."""
        actions: list[PlannedAction] = []
        for share in (share for wave in waves for share in wave):
            found = self._plan(self._ordered(share))
            if found is None:
                return None
            actions += found
        with self._search.stage("scheduling"):
            return actions if applicable(self._search.compilation, actions) else None

    def _ordered(self, share: Share) -> Share:
        """Return the share with helpers of one kind in the order that gives the shortest plan, if that counts."""
        if self._task.objective != "makespan":
            return share
        kinds = self._allocation.demand(share.group, share.helpers).kinds
        groups = [[h for h, k in zip(share.helpers, kinds, strict=True) if k == kind] for kind in dict.fromkeys(kinds)]
        orders = islice(product(*(permutations(group) for group in groups)), _ORDERS)
        shares = [Share(share.group, tuple(sum(order, ())), share.returning) for order in orders]
        return min(shares, key=self._makespan) if len(shares) > 1 else share

    def _makespan(self, share: Share) -> float:
        """Return how long a group takes by itself [s]."""
        compilation = self._search.compilation
        try:
            with self._search.stage("scheduling"):
                instances = decode(compilation, self._plan(share) or ())
                return schedule(self._task, instances, (), self._search.estimates).makespan
        except (UndecodableError, InfeasibleScheduleError):
            return float("inf")
