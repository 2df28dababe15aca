"""Allocation of helpers, e.g. hands, to groups of goals.

Each group gets the closest helpers of the kinds that its plan needs. If there are too few helpers for all groups at
once, some groups get their helpers in a later wave.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np

from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.facts import StaticFacts
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.symbolic.strategies.groups import Group, Helpers, Signature

_NEAR = 6
"""Minimum number of closest helpers to consider for a group. If these do not suffice, all helpers are considered."""
_CHOICES = 8
"""Maximum number of combinations of helper kinds to try for one group and one number of helpers."""
_MOST_ORDERS = 8
"""Maximum number of orders of groups to try if some groups have to wait for their helpers."""


@dataclass(frozen=True)
class Demand:
    """A group, and the kind of each helper that its plan needs, in the order of the helpers in the plan."""

    group: Group
    kinds: tuple[Signature, ...]


@dataclass(frozen=True)
class Share:
    """A group, and the names of its helpers, in the order of the helpers in the group's plan."""

    group: Group
    helpers: tuple[str, ...]
    returning: bool = False
    """Whether a later wave needs one of these helpers again."""


class Allocation:
    """Assigns the helpers of a task to its groups."""

    def __init__(
        self,
        task: Task,
        groups: Sequence[Group],
        holding: Collection[Atom],
        feasible: StaticFacts,
        deadline: Deadline = NEVER,
    ) -> None:
        views = {group: Helpers(task, group, holding, feasible, deadline) for group in groups}
        self._views: Mapping[Group, Helpers] = views

    def considered(self, group: Group, count: int) -> tuple[str, ...]:
        """Return the helpers to consider for a group that needs `count` helpers, closest first."""
        return tuple(self._views[group].closest[: max(_NEAR, 2 * count)])

    def choices(self, group: Group, count: int) -> Iterator[tuple[str, ...]]:
        """Yield combinations of `count` helpers for a group, closest first. No two have the same kinds of helpers."""
        view = self._views[group]
        kinds: dict[Signature, list[str]] = {}
        for name in self.considered(group, count):
            kinds.setdefault(view.signature(name), []).append(name)
        useful = [kind for kind in kinds if not any(map(kind.less_than, kinds))]
        found: list[tuple[float, tuple[str, ...]]] = []
        for chosen in combinations_with_replacement(sorted(useful), count):
            wanted = {kind: chosen.count(kind) for kind in chosen}
            if all(number <= len(kinds[kind]) for kind, number in wanted.items()):
                names = tuple(name for kind, number in wanted.items() for name in kinds[kind][:number])
                found.append((sum(map(view.distance, names)), names))
        yield from (names for _, names in sorted(found)[:_CHOICES])

    def demand(self, group: Group, helpers: Sequence[str]) -> Demand:
        """Return the demand of a group whose plan uses the given helpers."""
        return Demand(group, tuple(map(self._views[group].signature, helpers)))

    def shares_in_orders(self, demands: Sequence[Demand]) -> Iterator[list[list[Share]]]:
        """Yield waves of shares, first for the given order of demands. If one wave suffices, nothing else is yielded.

        If there are too few helpers for one wave, the last wave begins where the earlier waves leave the helpers, so
        the makespan depends on the groups that wait. So each demand in turn waits for the others.
        """
        first = self.shares(demands)
        if first is None:
            return
        yield first
        if len(first) > 1:
            for last in demands[: _MOST_ORDERS - 1]:
                waves = self.shares([*(each for each in demands if each is not last), last])
                if waves is not None and waves != first:
                    yield waves

    def shares(self, demands: Sequence[Demand]) -> list[list[Share]] | None:
        """Return waves of shares, or None if a demand cannot be met. In a wave, each helper has at most one group."""
        waves: list[list[Share]] = []
        left = list(demands)
        while left:
            wave, left = self._wave(left)
            if not wave:
                return None
            waves.append(wave)
        return _mark_returns(waves)

    def _wave(self, demands: Sequence[Demand]) -> tuple[list[Share], list[Demand]]:
        """Return a pair: the shares for the demands that can be met at once, and the remaining demands."""
        names = self._views[demands[0].group].closest
        at_once = min(len(demands), len(names) // max(1, len(demands[0].kinds)))
        shares: list[Share] = []
        for near in (True, False):
            shares = self._match([(demand, self._costs(demand, names, near)) for demand in demands], names)
            if len(shares) >= at_once:
                break
        met = {share.group for share in shares}
        return shares, [demand for demand in demands if demand.group not in met]

    @staticmethod
    def _match(demands: Sequence[tuple[Demand, FloatArray]], names: Sequence[str]) -> list[Share]:
        """Return shares for demands that can be met together. Earlier demands have priority."""
        met: list[tuple[Demand, FloatArray]] = []
        columns: list[int] = []
        for each in demands:
            matched = cheapest_matching(np.concatenate([costs for _, costs in [*met, each]]))
            if matched is not None:
                met, columns = [*met, each], matched
            if len(columns) + len(each[0].kinds) > len(names):
                break
        chosen = iter(columns)
        return [Share(demand.group, tuple(names[next(chosen)] for _ in demand.kinds)) for demand, _ in met]

    def _costs(self, demand: Demand, names: Sequence[str], near: bool) -> FloatArray:
        """Return distances of helpers to the group [m], infinity for unsuitable helpers. Shape ``(kinds, names)``."""
        view, costs = self._views[demand.group], np.full((len(demand.kinds), len(names)), np.inf)
        candidates = self.considered(demand.group, len(demand.kinds)) if near else view.closest
        for name in candidates:
            for row, kind in enumerate(demand.kinds):
                if view.signature(name) == kind:
                    costs[row, names.index(name)] = view.distance(name)
        return costs


def cheapest_matching(costs: FloatArray) -> list[int] | None:
    """Return a column for each row, all different, with the least sum of costs. Return None if this is impossible.

    Args:
        costs: Costs of shape ``(rows, columns)``. An infinite cost forbids a pair of row and column.
    """
    # The import takes half a second, and most tasks need no matching.
    from scipy.optimize import linear_sum_assignment

    if costs.shape[0] > costs.shape[1]:
        return None
    # A forbidden pair costs more than all allowed pairs together, so the pair is chosen only if this is unavoidable.
    allowed = np.isfinite(costs)
    finite = np.where(allowed, costs, 1.0 + costs[allowed].sum())
    rows, columns = linear_sum_assignment(finite)
    return [int(column) for column in columns] if allowed[rows, columns].all() else None


def _mark_returns(waves: list[list[Share]]) -> list[list[Share]]:
    """Mark a share as returning if a later wave needs one of its helpers again."""
    marked: list[list[Share]] = []
    needed: set[str] = set()
    for wave in reversed(waves):
        marked.insert(0, [Share(s.group, s.helpers, returning=bool(needed & set(s.helpers))) for s in wave])
        needed.update(name for share in wave for name in share.helpers)
    return marked
