"""Objective of the mid-level planner: minimise violations, then maximise the weighted sum of performance measures.

An objective scores rollouts on forward models and runs in physics alike.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from hybrid_tamp.midlevel.predictions import Chosen, Condition, Key, Rollout
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.midlevel.search_space import SearchSpace, Variable
from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

RESERVE = 0.5
"""Largest reserve, as a multiple of the predicate's scale. A reserve is a margin that every candidate must keep.

A predicate's scale converts margins to violations without unit: a margin of ``-scale`` is a violation of 1.
"""
_ROUNDING = 1e-9
"""Largest shortfall from a reserve that is treated as a rounding error, as a multiple of the predicate's scale."""

Reserves = Mapping[tuple[str, Atom], float]
"""Maps each pair of (instance or `GOAL`, atom) to its reserve, in the unit of the predicate."""


class RollOut(Protocol):
    """Interface of rollout functions such as `Rollouts`."""

    def __call__(self, chosen: Chosen, count: int, until: str | None = None) -> Rollout:
        """Roll out a population.

        Args:
            chosen: maps each pair of (instance, hyperparameter) to the values of all candidates, shape ``(n,)``. All
                other hyperparameters keep the value in the plan or, if the plan has no value, the initial value.
            count: size n of the population.
            until: name of an instance. The rollout may stop after the exit of the instance. None means the whole plan.
        """


@dataclass(frozen=True, eq=False)
class Objective:
    """Violation V and value J of a plan as functions of its hyperparameters.

    Attributes:
        task: task of the plan.
        plan: plan whose hyperparameters vary.
        roll_out: function that rolls out candidates.
        until: name of an instance. Rollouts may stop after the exit of this instance. If None, rollouts are complete.
        reserves: margins that candidates must keep. None if the reserves are not yet known.
    """

    task: Task
    plan: TaskPlan
    roll_out: RollOut
    until: str | None = None
    reserves: Reserves | None = None

    @cached_property
    def _variables(self) -> Mapping[Key, Variable]:
        return dict(_variables(self.task, self.plan))

    @property
    def keys(self) -> tuple[Key, ...]:
        """Pair of (instance, hyperparameter) for each variable."""
        return tuple(self._variables)

    @cached_property
    def space(self) -> SearchSpace:
        """Search space of the hyperparameters of all instances, in the order of the plan."""
        return SearchSpace(tuple(self._variables.values()))

    def __call__(self, points: FloatArray) -> Scores:
        """Return the scores of points of the space. ``points`` has shape ``(n, d)``."""
        return self.score(self.rollout(points, self.until))

    def rollout(self, points: FloatArray, until: str | None = None) -> Rollout:
        """Roll out points of shape ``(n, d)``, at least until the exit of the instance ``until``."""
        columns = dict(zip(self.keys, np.asarray(points, dtype=np.float64).T, strict=True))
        return self.roll_out(columns, len(points), until)

    def score(self, rollout: Rollout) -> Scores:
        """Return the scores of a rollout."""
        return Scores(self.sum_violations(rollout), rollout.value)

    def sum_violations(self, rollout: Rollout) -> FloatArray:
        """Return the violation V plus the shortfalls from the reserves. Shape ``(n,)``."""
        return np.asarray(rollout.violation + _lacking(rollout.conditions, self.reserves or {}))

    def keep_reserves(self, rollout: Rollout) -> "Objective":
        """Return the objective with reserves, which are taken from the margins of the first candidate.

        Only the results of actions get a reserve (see `_is_result`). Without reserves, the search would trade the
        margins of the results for value until nothing is left, and the plan would fail in physics.
        """
        reserves: dict[tuple[str, Atom], float] = {}
        for c in rollout.conditions:
            if self._is_result(c) and c.margin[0] > 0:
                # If an atom is both an entry and an exit condition of an instance, the smaller reserve applies.
                key, reserve = (c.where, c.atom), min(RESERVE * c.predicate.scale, float(c.margin[0]))
                reserves[key] = min(reserve, reserves.get(key, reserve))
        return replace(self, reserves=reserves)

    def _is_result(self, condition: Condition) -> bool:
        """Return whether a condition depends on where an action leaves its tokens, and not on when the action ends.

        There are three kinds: goal atoms, functional conditions (e.g. that an object is inside a region), and
        feasibility conditions, which depend on the poses from which later actions start.
        """
        predicate = condition.predicate
        result = condition.atom in self.task.goal or predicate.kind is Kind.FUNCTIONAL or predicate.static
        return result and not condition.throughout

    def score_instance(self, rollout: Rollout, instance: BlockInstance) -> Scores:
        """Return the scores of a rollout for the conditions and measures of one instance only."""
        mine = [c for c in rollout.conditions if c.where == instance.name]
        count = len(rollout.value)
        violation = np.sum([c.violation for c in mine], axis=0) + _lacking(mine, self.reserves or {}) + np.zeros(count)
        bad = np.logical_or.reduce([np.zeros(count, dtype=bool), *rollout.failed.values()])
        return Scores(np.where(bad, np.inf, violation), rollout.value_of(self.task, instance))


@dataclass
class Evaluator:
    """A scoring function that stores the rollouts of all scored candidates.

    Attributes:
        objective: the objective. If its reserves are unknown, the first candidate determines them.
        part: searched part of the space.
        batches: pair of (points, rollout) for each batch. The points have shape ``(n, d)`` and lie in the whole space.
    """

    objective: Objective
    part: SearchSpace
    batches: list[tuple[FloatArray, Rollout]] = field(default_factory=list)

    def __call__(self, points: FloatArray) -> Scores:
        """Return the scores of points of the searched part. ``points`` has shape ``(n, k)``."""
        whole = self.part.embed(points)
        rollout = self.objective.rollout(whole, self.objective.until)
        if self.objective.reserves is None:
            self.objective = self.objective.keep_reserves(rollout)
        self.batches.append((whole, rollout))
        return self.objective.score(rollout)

    @property
    def rollouts(self) -> list[Rollout]:
        """Rollouts of all batches."""
        return [rollout for _, rollout in self.batches]


def _lacking(conditions: Iterable[Condition], reserves: Reserves) -> FloatArray:
    """Return the sum of the shortfalls from the reserves, each as a multiple of the predicate's scale. Shape ``(n,)``.

    Negative margins are treated as 0, because the violation already includes them.
    """
    lacking = [
        (reserves[c.where, c.atom] - np.maximum(c.margin, 0.0)) / c.predicate.scale
        for c in conditions
        if (c.where, c.atom) in reserves and not c.throughout
    ]
    return np.asarray(np.sum([np.where(each > _ROUNDING, each, 0.0) for each in lacking], axis=0))


def find_last_measured(task: Task, plan: TaskPlan) -> str | None:
    """Return the name of the last instance with a performance measure, or None if the value depends on the end."""
    if task.midlevel.objective == "distance":
        return None
    measured = [i for i in plan.instances if task.domain.block_by_name[i.block].performance]
    return max(measured, key=lambda i: (i.end, i.name)).name if measured else None


def _variables(task: Task, plan: TaskPlan) -> Iterable[tuple[Key, Variable]]:
    """Yield (key, variable) for each hyperparameter. The default is the plan's value or, without it, the block's."""
    for instance in sorted(plan.instances, key=lambda i: (i.start, i.name)):
        block, binding = task.domain.block_by_name[instance.block], task.bind(instance.roles)
        for h in block.hyperparameters:
            given = instance.hyperparameters.get(h.name)
            with authored(f"{block.name}.{h.name}", binding):
                lower, upper = h.bounds(binding)
            default = float(block.initial_value(h, binding, task.state)) if given is None else given
            key = (instance.name, h.name)
            yield key, Variable(".".join(key), h.unit, lower, upper, float(np.clip(default, lower, upper)))
