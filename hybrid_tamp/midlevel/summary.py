"""Summary of a search as a refined plan. The best candidates of the search are rolled out over the whole plan."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from hybrid_tamp.midlevel.objective import Objective, RollOut
from hybrid_tamp.midlevel.physics_refinement import RefinedInPhysics
from hybrid_tamp.midlevel.plan_search import Searched
from hybrid_tamp.midlevel.predictions import Interval, Rollout
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.refined import Performance, RefinedPlan, Tuned, Value
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

NEARBY = "nearby"
"""Name of the search near the default hyperparameters (`nearby`)."""
_DIGITS = 6
"""Number of decimal places of times [s]."""


@dataclass(frozen=True, eq=False)
class Candidates:
    """The candidates that remain after a search.

    The candidates are the defaults, the optimum and, if computed, the result of optimising each action separately.

    Attributes:
        rollout: rollout of all candidates over the whole plan.
        points: the candidates. Shape ``(n, d)``.
        chosen: index of the best candidate.
    """

    rollout: Rollout
    points: FloatArray
    chosen: int

    @classmethod
    def of(cls, objective: Objective, *points: FloatArray) -> "Candidates":
        """Roll out the whole plan for several points of shape ``(d,)``, and choose the best point."""
        return cls.choose(objective, objective.rollout(np.array(points)), np.array(points))

    @classmethod
    def choose(cls, objective: Objective, rollout: Rollout, points: FloatArray) -> "Candidates":
        """Choose the best of several points ``(n, d)`` that were rolled out over the whole plan."""
        chosen = np.lexsort((-rollout.value, objective.sum_violations(rollout)))[0]
        return cls(rollout, points, int(chosen))

    @property
    def point(self) -> FloatArray:
        """The best candidate. Shape ``(d,)``."""
        return np.asarray(self.points[self.chosen])

    @property
    def violation(self) -> float:
        """Violation V of the best candidate."""
        return self.value(self.chosen).violation

    def value(self, candidate: int) -> Value:
        """Return violation V and value J of one candidate."""
        return Value(float(self.rollout.violation[candidate]), float(self.rollout.value[candidate]))

    def replace_best(self, objective: Objective, point: FloatArray) -> "Candidates":
        """Return the candidates with a new best point in place of the optimum. ``point`` has shape ``(d,)``."""
        points = np.vstack([self.points[:1], point, self.points[2:]])
        return Candidates(objective.rollout(points), points, 1)


def summarise_defaults(objective: Objective, defaults: Candidates, seconds: float) -> RefinedPlan:
    """Return the refined plan with default hyperparameters, for a plan with nothing to optimise."""
    tuned = _tune(objective, defaults.point, dict.fromkeys(objective.space.names, "kept"))
    return _summarise(objective, defaults, tuple(tuned), len(defaults.points), seconds)


def summarise_nearby(objective: Objective, candidates: Candidates, spent: int, seconds: float) -> RefinedPlan:
    """Return the refined plan with the best candidate of a search near the defaults.

    Args:
        objective: objective of the plan.
        candidates: the defaults and the best point.
        spent: number of rollouts.
        seconds: duration of the search [s].
    """
    names, moved = objective.space.names, candidates.point != candidates.points[0]
    statuses = {name: "optimised" if changed else "kept" for name, changed in zip(names, moved.tolist(), strict=True)}
    tuned = tuple(_tune(objective, candidates.point, statuses))
    found = _summarise(objective, candidates, tuned, spent, seconds)
    return replace(found, optimiser=NEARBY, stopped="converged")


def summarise(
    searched: Searched, candidates: Candidates, in_physics: RefinedInPhysics | None, seconds: float
) -> RefinedPlan:
    """Return the refined plan with the hyperparameters of the best candidate.

    Args:
        searched: result of the search.
        candidates: candidates that remain after the search.
        in_physics: result of the refinement in physics, or None if not requested.
        seconds: duration of the optimisation [s].
    """
    objective, optimum, influence = searched.objective, searched.optimum, searched.influence
    relevant = searched.screening.relevant
    names = objective.space.names
    statuses = {name: "optimised" if name in relevant else "free" for name in names}
    tuned = list(_tune(objective, candidates.point, statuses))
    tuned = [replace(each, moves=influence.moves.get(name, ())) for name, each in zip(names, tuned, strict=True)]
    if searched.apart is not None:
        tuned = [replace(each, apart=float(at)) for each, at in zip(tuned, searched.apart, strict=True)]
    found = replace(
        _summarise(
            objective,
            candidates,
            tuple(tuned),
            searched.spent + (0 if searched.whole else len(candidates.points)),
            seconds,
        ),
        apart=None if searched.apart is None else candidates.value(-1),
        optimiser=objective.task.midlevel.optimiser,
        stopped=optimum.stopped,
        history=optimum.history,
    )
    if in_physics is None:
        return found
    return replace(found, physics=in_physics.retuning, shortfall=in_physics.shortfall)


def _summarise(
    objective: Objective, candidates: Candidates, tuned: tuple[Tuned, ...], spent: int, seconds: float
) -> RefinedPlan:
    """Return the refined plan with the best candidate, without the fields that only a search determines."""
    rollout, chosen = candidates.rollout, candidates.chosen
    values = dict(zip(objective.keys, candidates.point.tolist(), strict=True))
    plan, short = objective.plan.set_hyperparameters(values), rollout.worst(chosen)
    margins = {(c.where, c.atom): float(c.margin[chosen]) for c in rollout.conditions if not c.throughout}
    return RefinedPlan(
        plan=plan if short is not None else _retime(objective.task, plan, rollout.intervals, chosen),
        hyperparameters=tuned,
        performance=tuple(_expect_performance(objective, candidates)),
        best=candidates.value(chosen),
        defaults=candidates.value(0),
        apart=None,
        shortfall=None if short is None else short.at(chosen),
        expected=margins,
        optimiser="",
        evaluations=spent,
        seconds=seconds,
        stopped="",
        history=(),
    )


def time_plan(task: Task, plan: TaskPlan, rollouts: RollOut) -> TaskPlan:
    """Return a plan with a value for every hyperparameter with the times of its rollout."""
    chosen = {
        (each.name, name): np.array([value]) for each in plan.instances for name, value in each.hyperparameters.items()
    }
    return _retime(task, plan, rollouts(chosen, 1).intervals, 0)


def _retime(task: Task, plan: TaskPlan, intervals: Mapping[str, Interval], candidate: int) -> TaskPlan:
    """Return a plan with the times that the rollout of one candidate predicts."""
    times: dict[str, tuple[float, float | None, float]] = {}
    for instance in plan.instances:
        start, reached, end = (round(float(time[candidate]), _DIGITS) for time in intervals[instance.name])
        times[instance.name] = (start, reached if task.domain.block_by_name[instance.block].hold else None, end)
    return plan.retime(times)


def _tune(objective: Objective, point: FloatArray, statuses: dict[str, str]) -> Iterator[Tuned]:
    """Yield each hyperparameter with its value at the point. A hyperparameter with equal bounds is "fixed"."""
    for key, variable, value in zip(objective.keys, objective.space.variables, point.tolist(), strict=True):
        status = statuses[variable.name] if variable.lower < variable.upper else "fixed"
        yield Tuned(*key, variable.unit, variable.lower, variable.upper, variable.default, value, status)


def _expect_performance(objective: Objective, candidates: Candidates) -> Iterator[Performance]:
    figures = candidates.rollout.figures
    for instance in sorted(objective.plan.instances, key=lambda i: (i.start, i.name)):
        for m in objective.task.domain.block_by_name[instance.block].performance:
            figure = float(figures[instance.name, m.name][candidates.chosen])
            yield Performance(instance.name, m.name, m.unit, m.weight, m.scale, figure)
