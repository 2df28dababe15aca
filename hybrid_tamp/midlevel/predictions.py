"""The predicted outcome of a population of candidates: margins, performance measures, times and final states."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.goal_distance import measure_goal_distance
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Atom, Predicate
from hybrid_tamp.model.refined import Shortfall
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

Key = tuple[str, str]
"""Pair of (instance, hyperparameter) or (instance, measure)."""

Chosen = Mapping[Key, FloatArray]
"""Maps each pair of (instance, hyperparameter) to the values of all candidates. Shape ``(n,)``."""


@dataclass(frozen=True, eq=False)
class Condition:
    """One condition with its margins for all candidates.

    Attributes:
        where: name of the instance to which the condition belongs, or `GOAL` for a goal atom.
        atom: the ground condition.
        predicate: predicate of the condition. A margin of ``-predicate.scale`` is a violation of 1.
        margin: signed margins, in the unit of the predicate. Not finite for failed rollouts. Shape ``(n,)``.
        throughout: whether the condition is an invariant. Its margin is then the least margin until the exit.
    """

    where: str
    atom: Atom
    predicate: Predicate
    margin: FloatArray
    throughout: bool = False

    @property
    def violation(self) -> FloatArray:
        """Violation of the condition, as a multiple of the predicate's scale. Shape ``(n,)``."""
        return np.asarray(np.maximum(0.0, -self.margin) / self.predicate.scale)

    def at(self, candidate: int) -> Shortfall:
        """Return the shortfall of a candidate that violates the condition."""
        return Shortfall(self.where, self.atom, self.predicate.unit, float(self.margin[candidate]))


class Interval(NamedTuple):
    """Times of one instance for all candidates, each of shape ``(n,)`` [s].

    Attributes:
        start: time at which the instance starts.
        reached: time at which its exit conditions first hold.
        end: time at which the instance ends.
    """

    start: FloatArray
    reached: FloatArray
    end: FloatArray


class Trace(NamedTuple):
    """The movement of one instance in a rollout of a single candidate.

    Attributes:
        states: states of the instance's tokens from its start to its exit, one per control step. Shape ``(t, m)``.
        world: states of all tokens at the start of the instance. A token that another instance moves at this time may
            already be where that instance leaves it. Shape ``(layout.size,)``.
    """

    states: State
    world: State


def weigh_plan(
    task: Task, plan: Iterable[BlockInstance], figures: Mapping[Key, FloatArray], final: State
) -> FloatArray:
    """Return the value J of a plan, shape ``(n,)``. Measures without a figure count as 0.

    Args:
        task: task whose `midlevel.objective` defines the value.
        plan: instances of the plan.
        figures: maps each pair of (instance, performance measure) to the figures of all candidates. Shape ``(n,)``.
        final: states at the end of the plan. Shape ``(n, layout.size)``.
    """
    if task.midlevel.objective == "distance":
        return -measure_goal_distance(task, final)
    value = np.zeros(len(final.values))
    for instance in plan:
        for measure in task.domain.block_by_name[instance.block].performance:
            value = value + measure.weight * figures.get((instance.name, measure.name), 0.0) / measure.scale
    return value


@dataclass(frozen=True, eq=False)
class Rollout:
    """The predicted outcome of a population.

    Attributes:
        conditions: entry and exit conditions of all instances in order, followed by the goal atoms.
        figures: maps each pair of (instance, performance measure) to the figures of all candidates. Shape ``(n,)``.
        value: value J, which is the weighted sum of the performance measures. Shape ``(n,)``.
        final: final states. Shape ``(n, layout.size)``.
        intervals: maps each instance to the times of its start, its exit and its end.
        failed: maps each instance to a mask of the candidates that failed in it, because a value was not finite.
    """

    conditions: tuple[Condition, ...]
    figures: Mapping[Key, FloatArray]
    value: FloatArray
    final: State
    intervals: Mapping[str, Interval]
    failed: Mapping[str, NDArray[np.bool_]]

    @property
    def violation(self) -> FloatArray:
        """Violation V, the sum over all conditions. Infinite for failed rollouts. Shape ``(n,)``."""
        total = np.sum([condition.violation for condition in self.conditions], axis=0) + np.zeros(len(self.value))
        for where in self.failed.values():
            total = np.where(where, np.inf, total)
        return np.where(np.isfinite(total), total, np.inf)

    def pick(self, candidate: int) -> "Rollout":
        """Return the rollout of one candidate as a population with one candidate."""
        one = slice(candidate, candidate + 1)
        return Rollout(
            conditions=tuple(replace(c, margin=c.margin[one]) for c in self.conditions),
            figures={key: figure[one] for key, figure in self.figures.items()},
            value=self.value[one],
            final=State(self.final.layout, self.final.values[one]),
            intervals={name: Interval(*(time[one] for time in times)) for name, times in self.intervals.items()},
            failed={name: where[one] for name, where in self.failed.items() if where[candidate]},
        )

    def worst(self, candidate: int = 0) -> Condition | None:
        """Return the first violated condition of a candidate, in plan order, or None if all conditions hold."""
        return next((c for c in self.conditions if not c.margin[candidate] >= 0), None)

    def value_of(self, task: Task, instance: BlockInstance) -> FloatArray:
        """Return the weighted sum of the performance measures of one instance. Shape ``(n,)``.

        If the objective is the distance to the goal, the value is 0, because no instance has a distance of its own.
        """
        if task.midlevel.objective == "distance":
            return np.zeros(len(self.value))
        measures = task.domain.block_by_name[instance.block].performance
        terms = [m.weight * self.figures[instance.name, m.name] / m.scale for m in measures]
        return np.asarray(np.sum(terms, axis=0) + np.zeros(len(self.value)))
