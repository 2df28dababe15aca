"""The mid-level planner (paper, Sec. II-D): the hyperparameters of all actions of a plan, optimised together.

First the defaults are tried. Where they meet every condition and there is no measure to improve, they are kept. Else
it is found out which hyperparameters have an effect at all; the others are left at their defaults, which shrinks the
space that is searched. The optimum is never worse than the defaults, nor than each action optimised on its own.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from hybrid_tamp.errors import DomainError, Issue
from hybrid_tamp.midlevel.objective import Objective, RollOut
from hybrid_tamp.midlevel.optimiser import Budget, NothingFinite, Optimum, find_optimiser
from hybrid_tamp.midlevel.relevance import Relevance, find_relevant
from hybrid_tamp.midlevel.retuning import Retuner
from hybrid_tamp.midlevel.rollout import Rollout, Rollouts
from hybrid_tamp.midlevel.search_space import FloatArray
from hybrid_tamp.midlevel.separate import optimised_apart
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.refined import Milestone, Performance, RefinedPlan, Shortfall, Tuned, Value
from hybrid_tamp.model.task import Task

Progress = Callable[[float, Milestone], None]
"""Called with the share of the budget that is spent, 0 to 1, and the best so far."""

_BATCH = 48
"""Candidates of a generation: rolled out together they cost little more than one."""
_SCREENING = 0.4
"""Largest share of the budget that is spent on finding out what matters."""
_BASES = (4, 32)
"""How many base points, at least and at most, that takes."""


class NotFinite(DomainError):
    """Every rollout of a plan failed: a block of the domain computes nothing finite; the message names the first."""


def refine(
    task: Task,
    plan: TaskPlan,
    progress: Progress | None = None,
    roll_out: RollOut | None = None,
    compare: bool = True,
    measured: RollOut | None = None,
) -> RefinedPlan:
    """Optimise the hyperparameters of a plan, by the settings of its task.

    Args:
        task: the task, its goal without a choice.
        plan: a lawful plan of it.
        progress: told how far the work is.
        roll_out: what rolls candidates out; by default the blocks' forward models.
        compare: whether to tell as well what comes of it when each action is optimised on its own.
        measured: what runs candidates in physics, for the last refinement where the task asks for one.

    Raises:
        NotFinite: every rollout failed.
    """
    return _Refinement(task, plan, progress, roll_out or Rollouts(task, plan), measured).refined(compare)


class _Refinement:
    """The work on one plan."""

    def __init__(
        self, task: Task, plan: TaskPlan, progress: Progress | None, roll_out: RollOut, measured: RollOut | None
    ) -> None:
        self.task, self.plan = task, plan
        self.began = time.monotonic()
        self.tell = progress or (lambda share, best: None)
        self.objective = Objective(task, plan, roll_out)
        asked = measured if task.midlevel.refine == "physics" else None
        self.measured = None if asked is None else Objective(task, plan, asked)
        self.rng = np.random.default_rng(task.seed)
        self.evaluations = 0
        self.moves: dict[str, list[str]] = {}

    def refined(self, compare: bool) -> RefinedPlan:
        space, settings = self.objective.space, self.task.midlevel
        defaults = self._at(space.default)
        measures = any(self.task.domain.block_by_name[i.block].performance for i in self.plan.instances)
        if not space.varying or (defaults.violation[0] == 0 and not measures):
            return self._outcome(defaults, space.default, defaults)
        self.tell(0.0, Milestone(1, float(defaults.violation[0]), float(defaults.value[0])))
        relevance = self._relevance()
        best = self._optimum(relevance)
        self.evaluations += best.evaluations
        point, apart = best.point, None
        if compare and measures:
            apart = optimised_apart(self.objective, set(relevance.relevant))
            point = min((point, apart), key=lambda candidate: _order(self._at(candidate)))
        retuned = None
        if self.measured is not None and relevance.relevant:
            retuner = Retuner(self.objective, self.measured, settings, self.rng, self.tell)
            point, shortfall, retuned = retuner.retune(point, relevance.relevant)
        outcome = self._outcome(self._at(point), point, defaults, relevance, apart)
        if retuned is not None:
            outcome = replace(outcome, physics=retuned, shortfall=shortfall)
        history = tuple(Milestone(*each) for each in best.history)
        return replace(outcome, optimiser=settings.optimiser, stopped=best.stopped, history=history)

    def _at(self, point: FloatArray) -> Rollout:
        """Roll out one point ``(d,)``."""
        return self.objective.rollout(point[None])

    def _relevance(self) -> Relevance:
        varying = len(self.objective.space.varying)
        affordable = int(_SCREENING * self.task.midlevel.evaluations / (4 * varying + 1))
        bases = int(np.clip(affordable, *_BASES))
        try:
            found = find_relevant(self.objective, self.objective.space, self.rng, bases=bases)
        except NothingFinite as error:
            raise self._not_finite(error) from error
        self.evaluations += found.evaluations
        for (instance, measure), figures in self._sampled().items():
            for name in found.moving(figures):
                self.moves.setdefault(name, []).append(f"{instance}.{measure}")
        return found

    def _sampled(self) -> Mapping[tuple[str, str], FloatArray]:
        """Return the performance measures of the population that was rolled out last."""
        return self.objective.last.figures if self.objective.last is not None else {}

    def _optimum(self, relevance: Relevance) -> Optimum:
        settings, space = self.task.midlevel, self.objective.space
        part = space.only(relevance.relevant)
        left = max(1, settings.evaluations - self.evaluations)
        seconds = max(0.1, settings.seconds - (time.monotonic() - self.began))
        optimise = find_optimiser(settings.optimiser, batch=_BATCH)

        def told(milestone: tuple[int, float, float]) -> None:
            share = max(milestone[0] / left, (time.monotonic() - self.began) / settings.seconds)
            self.tell(min(share, 1.0), Milestone(*milestone))

        try:
            optimum = optimise(lambda p: self.objective(part.embed(p)), part, Budget(left, seconds), self.rng, told)
        except NothingFinite as error:
            raise self._not_finite(error) from error
        return replace(optimum, point=part.embed(optimum.point[None])[0])

    def _not_finite(self, error: NothingFinite) -> NotFinite:
        """Name the block in which something first was not finite."""
        assert self.objective.last is not None, "it has been rolled out"
        failed = self.objective.last.failed
        where = next((i for i in self.plan.instances if i.name in failed), None)
        if where is None:
            return NotFinite([Issue("", str(error))])
        return NotFinite([Issue(where.name, str(error), remedy=f"there the block {where.block} first computed it")])

    def _outcome(
        self,
        rollout: Rollout,
        point: FloatArray,
        defaults: Rollout,
        relevance: Relevance | None = None,
        apart: FloatArray | None = None,
    ) -> RefinedPlan:
        values = dict(zip(self.objective.keys, point.tolist(), strict=True))
        short = rollout.worst()
        return RefinedPlan(
            plan=_with_values(self.plan, values),
            hyperparameters=self._tuned(point, relevance, apart),
            performance=tuple(self._performance(rollout)),
            best=_value(rollout),
            defaults=_value(defaults),
            apart=None if apart is None else _value(self._at(apart)),
            shortfall=None if short is None else Shortfall(short.where, short.atom, short.unit, float(short.margin[0])),
            expected={(c.where, c.atom): float(c.margin[0]) for c in rollout.conditions},
            optimiser="",
            evaluations=self.evaluations + 1,
            seconds=time.monotonic() - self.began,
            stopped="",
            history=(),
        )

    def _tuned(self, point: FloatArray, relevance: Relevance | None, apart: FloatArray | None) -> tuple[Tuned, ...]:
        found = []
        for index, (key, variable) in enumerate(zip(self.objective.keys, self.objective.space.variables, strict=True)):
            status = "kept"
            if relevance is not None:
                status = "optimised" if variable.name in relevance.relevant else "free"
            own = None if apart is None else float(apart[index])
            bounds = (variable.lower, variable.upper, variable.default)
            moves = tuple(self.moves.get(variable.name, ()))
            found.append(Tuned(*key, variable.unit, *bounds, float(point[index]), status, moves, own))
        return tuple(found)

    def _performance(self, rollout: Rollout) -> list[Performance]:
        return [
            Performance(i.name, m.name, m.unit, m.weight, m.scale, float(rollout.figures[i.name, m.name][0]))
            for i in sorted(self.plan.instances, key=lambda i: (i.start, i.name))
            for m in self.task.domain.block_by_name[i.block].performance
        ]


def _value(rollout: Rollout) -> Value:
    return Value(float(rollout.violation[0]), float(rollout.value[0]))


def _order(rollout: Rollout) -> tuple[float, float]:
    """Return what is smaller for the better of two rollouts of one candidate."""
    return float(rollout.violation[0]), -float(rollout.value[0])


def _with_values(plan: TaskPlan, values: dict[tuple[str, str], float]) -> TaskPlan:
    """Return the plan with these hyperparameters."""
    instances = []
    for instance in plan.instances:
        mine = {name: value for (owner, name), value in values.items() if owner == instance.name}
        instances.append(replace(instance, hyperparameters={**instance.hyperparameters, **mine}))
    return replace(plan, instances=tuple(instances))
