"""The objective of the mid-level planner: violations first, then the weighted sum of performance measures.

It is the same whether the blocks' forward models roll out a whole population at once, or physics runs each candidate.
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
"""Margin that searches keep of each goal atom, where it has as much by default [scales of its predicate]."""


class RollOut(Protocol):
    """A way to find out what comes of a population."""

    def __call__(self, chosen: Chosen, count: int, until: str | None = None) -> Rollout:
        """Return what comes of it, until the exit of one instance at least; as `Rollouts` does."""


@dataclass(frozen=True, eq=False)
class Objective:
    """V and J of a plan as functions of its hyperparameters.

    Attributes:
        task: the task.
        plan: the plan.
        roll_out: what rolls candidates out.
        until: the instance after whose exit points are not rolled out any further, or None.
        reserves: goal atom to the margin that a search keeps of it [its unit]; None until that is known.
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
        """Roll out points ``(n, d)``, until the exit of one instance at least."""
        columns = dict(zip(self.keys, np.asarray(points, dtype=np.float64).T, strict=True))
        return self.roll_out(columns, len(points), until)

    def score(self, rollout: Rollout) -> Scores:
        """Return the scores of a population that was rolled out."""
        return Scores(self.missed(rollout), rollout.value)

    def missed(self, rollout: Rollout) -> FloatArray:
        """Return V, and how much of their reserves goal atoms lack where they are brought about, shape ``(n,)``."""
        return np.asarray(rollout.violation + _lacking(rollout.conditions, self.reserves or {}))

    def keep_reserves(self, rollout: Rollout) -> "Objective":
        """Return the objective that keeps some of the margins which goal atoms have for the first of some candidates.

        The value of a plan must not be bought with the last of a goal's margin: physics would miss it by a hair.
        """
        goal = set(self.task.goal)
        found = [condition for condition in rollout.conditions if condition.atom in goal and condition.margin[0] > 0]
        return replace(self, reserves={c.atom: min(RESERVE * c.scale, float(c.margin[0])) for c in found})

    def own(self, instance: BlockInstance) -> Callable[[FloatArray], Scores]:
        """Return the objective of one instance alone: its own conditions and its own measures."""

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
    """Scores candidates of a search and keeps what came of them.

    Attributes:
        objective: the objective; where its reserves are not known yet, the first candidate sets them.
        part: the part of the space that is searched.
        batches: the points ``(n, d)`` of the whole space that were rolled out together, and what came of them.
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
        """What came of each batch."""
        return [rollout for _, rollout in self.batches]


def _lacking(conditions: Iterable[Condition], reserves: Mapping[Atom, float]) -> FloatArray:
    """Return what margins lack of the reserves beyond what is missing anyway, in units of their scales."""
    lacking = [
        np.maximum(reserves[c.atom] - np.maximum(c.margin, 0.0), 0.0) / c.scale
        for c in conditions
        if c.atom in reserves
    ]
    return np.asarray(np.sum(lacking, axis=0))


def find_last_measured(task: Task, plan: TaskPlan) -> str | None:
    """Return the name of the last instance with a performance measure."""
    measured = [i for i in plan.instances if task.domain.block_by_name[i.block].performance]
    return max(measured, key=lambda i: (i.end, i.name)).name if measured else None


def _variables(task: Task, plan: TaskPlan) -> Iterable[tuple[Key, Variable]]:
    """Yield the hyperparameters of the plan; the default is the plan's value, else the initial value at the start."""
    for instance in sorted(plan.instances, key=lambda i: (i.start, i.name)):
        block, binding = task.domain.block_by_name[instance.block], task.bind(instance.roles)
        for h in block.hyperparameters:
            lower, upper = h.bounds(binding)
            given = instance.hyperparameters.get(h.name)
            default = float(h.initial_value(binding, task.state)) if given is None else given
            key = (instance.name, h.name)
            yield key, Variable(".".join(key), h.unit, lower, upper, float(np.clip(default, lower, upper)))
