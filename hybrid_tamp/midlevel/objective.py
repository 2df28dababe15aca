"""The objective of the mid-level planner: violations first, then the weighted sum of performance measures.

It is the same for rollouts of a whole population by the blocks' forward models and for single runs in physics.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from hybrid_tamp.midlevel.rollout import Chosen, Condition, Key, Rollout
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.midlevel.search_space import SearchSpace, Variable
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

RESERVE = 0.5
"""Largest margin that a search reserves for each goal atom [scales of its predicate]."""


class RollOut(Protocol):
    """A way to roll out a population, such as `Rollouts`."""

    def __call__(self, chosen: Chosen, count: int, until: str | None = None) -> Rollout:
        """Roll out at least until the exit of one instance."""


@dataclass(frozen=True, eq=False)
class Objective:
    """V and J of a plan as functions of its hyperparameters.

    Attributes:
        task: the task.
        plan: the plan.
        roll_out: rolls out candidates.
        until: the instance after whose exit rollouts for scores may stop, or None.
        reserves: goal atom to the margin that a search reserves for it [its unit]; None until it is known.
    """

    task: Task
    plan: TaskPlan
    roll_out: RollOut
    until: str | None = None
    reserves: Mapping[Atom, float] | None = None

    @cached_property
    def _variables(self) -> Mapping[Key, Variable]:
        return dict(_variables(self.task, self.plan))

    @property
    def keys(self) -> tuple[Key, ...]:
        """(instance, hyperparameter) of each variable."""
        return tuple(self._variables)

    @cached_property
    def space(self) -> SearchSpace:
        """The hyperparameters of all instances, in the order of the plan."""
        return SearchSpace(tuple(self._variables.values()))

    def __call__(self, points: FloatArray) -> Scores:
        """Return the scores of points ``(n, d)`` of the space."""
        return self.score(self.rollout(points, self.until))

    def rollout(self, points: FloatArray, until: str | None = None) -> Rollout:
        """Roll out points ``(n, d)`` at least until the exit of one instance."""
        columns = dict(zip(self.keys, np.asarray(points, dtype=np.float64).T, strict=True))
        return self.roll_out(columns, len(points), until)

    def score(self, rollout: Rollout) -> Scores:
        """Return the scores of a rollout."""
        return Scores(self.sum_violations(rollout), rollout.value)

    def sum_violations(self, rollout: Rollout) -> FloatArray:
        """Return V plus the missing parts of the reserves of goal atoms, shape ``(n,)``."""
        return np.asarray(rollout.violation + _lacking(rollout.conditions, self.reserves or {}))

    def keep_reserves(self, rollout: Rollout) -> "Objective":
        """Return the objective that reserves part of the margins of goal atoms, as the first candidate has them.

        Without a reserve the search would trade the whole margin of the goal for value, and physics would just miss it.
        """
        goal = set(self.task.goal)
        found = [condition for condition in rollout.conditions if condition.atom in goal and condition.margin[0] > 0]
        return replace(self, reserves={c.atom: min(RESERVE * c.predicate.scale, float(c.margin[0])) for c in found})

    def restrict_to(self, instance: BlockInstance) -> Callable[[FloatArray], Scores]:
        """Return the objective of one instance alone: its own conditions and measures."""

        def evaluate(points: FloatArray) -> Scores:
            rollout = self.rollout(points, instance.name)
            mine = [c for c in rollout.conditions if c.where == instance.name]
            violation = (
                np.sum([c.violation for c in mine], axis=0)
                + _lacking(mine, self.reserves or {})
                + np.zeros(len(points))
            )
            bad = np.logical_or.reduce([np.zeros(len(points), dtype=bool), *rollout.failed.values()])
            return Scores(np.where(bad, np.inf, violation), rollout.value_of(self.task, instance))

        return evaluate


@dataclass
class Evaluator:
    """Scores the candidates of a search and keeps their rollouts.

    Attributes:
        objective: the objective; if its reserves are unknown, the first candidate sets them.
        part: the part of the space that is searched.
        batches: the points ``(n, d)`` of the whole space in each batch, with their rollout.
    """

    objective: Objective
    part: SearchSpace
    batches: list[tuple[FloatArray, Rollout]] = field(default_factory=list)

    def __call__(self, points: FloatArray) -> Scores:
        """Return the scores of points ``(n, k)`` of the part."""
        whole = self.part.embed(points)
        rollout = self.objective.rollout(whole, self.objective.until)
        if self.objective.reserves is None:
            self.objective = self.objective.keep_reserves(rollout)
        self.batches.append((whole, rollout))
        return self.objective.score(rollout)

    @property
    def rollouts(self) -> list[Rollout]:
        """The rollout of each batch."""
        return [rollout for _, rollout in self.batches]


def _lacking(conditions: Iterable[Condition], reserves: Mapping[Atom, float]) -> FloatArray:
    """Return the sum of the missing parts of reserves, without violations, in units of their scales."""
    lacking = [
        np.maximum(reserves[c.atom] - np.maximum(c.margin, 0.0), 0.0) / c.predicate.scale
        for c in conditions
        if c.atom in reserves
    ]
    return np.asarray(np.sum(lacking, axis=0))


def find_last_measured(task: Task, plan: TaskPlan) -> str | None:
    """Return the name of the last instance with a performance measure."""
    measured = [i for i in plan.instances if task.domain.block_by_name[i.block].performance]
    return max(measured, key=lambda i: (i.end, i.name)).name if measured else None


def _variables(task: Task, plan: TaskPlan) -> Iterable[tuple[Key, Variable]]:
    """Yield the hyperparameters of the plan; the default is the plan's value, else the initial value of the block."""
    for instance in sorted(plan.instances, key=lambda i: (i.start, i.name)):
        block, binding = task.domain.block_by_name[instance.block], task.bind(instance.roles)
        for h in block.hyperparameters:
            lower, upper = h.bounds(binding)
            given = instance.hyperparameters.get(h.name)
            default = float(h.initial_value(binding, task.state)) if given is None else given
            key = (instance.name, h.name)
            yield key, Variable(".".join(key), h.unit, lower, upper, float(np.clip(default, lower, upper)))
