"""The mid-level planner (paper, Sec. II-D): the hyperparameters of all actions of a plan, optimised together.

First the defaults are tried. Where they meet every condition and there is no measure to improve, they are kept. Else
it is found out which hyperparameters have an effect at all; the others are left at their defaults, which shrinks the
space that is searched. The optimum is never worse than the defaults, nor than each action optimised on its own.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from hybrid_tamp.errors import DomainError, Issue
from hybrid_tamp.midlevel.objective import Objective, RollOut, last_measured
from hybrid_tamp.midlevel.optimiser import Budget, NothingFinite, Optimum, find_optimiser
from hybrid_tamp.midlevel.retuning import Retuner
from hybrid_tamp.midlevel.rollout import Rollout, Rollouts
from hybrid_tamp.midlevel.scores import SAME, Scores
from hybrid_tamp.midlevel.screening import Effect, Relevance, find_relevant
from hybrid_tamp.midlevel.separate import optimised_apart
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.refined import MeasureKey, Milestone, Performance, RefinedPlan, Shortfall, Tuned, Value
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

Progress = Callable[[float, Milestone], None]
"""Called with the share of the budget that is spent, 0 to 1, and the best so far."""

_BATCHES = {"cma": 48}
"""Candidates of a generation, by optimiser: rolled out together they cost little more than one."""
_SCREENING = 0.4
"""Largest share of the budget that is spent on finding out what matters."""
_TOLERANCE = 1e-2
"""Effects up to this part of what is at stake are not worth a dimension more of the search."""
_BASES = (4, 6)
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


@dataclass(frozen=True, eq=False)
class _Compared:
    """A few candidates, the defaults first, and each action optimised on its own last; the whole plan rolled out.

    Attributes:
        rollout: what comes of them.
        points: the candidates, shape ``(n, d)``.
        chosen: the best of them.
    """

    rollout: Rollout
    points: FloatArray
    chosen: int

    @property
    def violation(self) -> float:
        """V of the best."""
        return self.value(self.chosen).violation

    def value(self, candidate: int) -> Value:
        """Return V and J of one."""
        return Value(float(self.rollout.violation[candidate]), float(self.rollout.value[candidate]))


class _Refinement:
    """The work on one plan."""

    def __init__(
        self, task: Task, plan: TaskPlan, progress: Progress | None, roll_out: RollOut, measured: RollOut | None
    ) -> None:
        self.task, self.plan = task, plan
        self.began = time.monotonic()
        self.tell = progress or (lambda share, best: None)
        self.objective = Objective(task, plan, roll_out)
        self.last_measured = self.objective.until = last_measured(task, plan)
        asked = measured if task.midlevel.refine == "physics" else None
        self.measured = None if asked is None else Objective(task, plan, asked)
        self.rng = np.random.default_rng(task.seed)
        self.evaluations = 0
        self.moves: dict[str, list[MeasureKey]] = {}
        self.own: set[str] = set()
        self.searched: list[Rollout] = []

    def refined(self, compare: bool) -> RefinedPlan:
        space, measures = self.objective.space, self.last_measured is not None
        if not measures or not space.varying:
            defaults = self.objective.rollout(space.default[None])
            if not space.varying or defaults.violation[0] == 0:
                return self._outcome(_Compared(defaults, space.default[None], 0))
        if not measures:
            self.objective.reserves = {}  # There is no value to buy with them.
        relevance, apart, best = self._in_a_line() if len(space.varying) == 1 else self._in_space(compare and measures)
        if compare and measures and apart is None:
            apart = optimised_apart(self.objective, self.own)
        self.evaluations += best.evaluations
        compared = self._compared(space.default, best.point, *([] if apart is None else [apart]))
        if self.objective.until is not None and best.violation == 0 and compared.violation > 0:
            # What comes after the last measure was left out, and does not come right by itself.
            self.objective.until = None
            return self.refined(compare)
        self.objective.until = None
        retuned = None
        if self.measured is not None and relevance.relevant:
            retuner = Retuner(self.objective, self.measured, self.task.midlevel, self.rng, self.tell)
            point, shortfall, retuned = retuner.retune(compared.points[compared.chosen], relevance.relevant)
            points = np.vstack([compared.points[:1], point, compared.points[2:]])
            compared = _Compared(self.objective.rollout(points), points, 1)
        history = tuple(Milestone(*each) for each in best.history)
        outcome = self._outcome(compared, relevance, apart)
        if retuned is not None:
            outcome = replace(outcome, physics=retuned, shortfall=shortfall)
        return replace(outcome, optimiser=self.task.midlevel.optimiser, stopped=best.stopped, history=history)

    def _in_space(self, compare: bool) -> tuple[Relevance, FloatArray | None, Optimum]:
        """Find out what matters, and search those variables from the defaults or from each action's own best."""
        relevance = self._relevance()
        own = {name for name in relevance.relevant if name in self.own}
        apart = optimised_apart(self.objective, own) if compare else None
        return relevance, apart, self._optimum(relevance, self._start(apart))

    def _in_a_line(self) -> tuple[Relevance, None, Optimum]:
        """Search one variable; a space of one dimension cannot shrink, and the search shows by itself what it moves."""
        (name,) = self.objective.space.varying
        everything = Relevance({name: Effect(np.inf, np.inf)}, Effect(0.0, 0.0), 0)
        best = self._optimum(everything, self.objective.space.default)
        # Of all that was searched: the last generation alone may lie where all are as good as each other.
        figures = {key: np.concatenate([r.figures[key] for r in self.searched]) for key in self.searched[0].figures}
        moved = [key for key, each in figures.items() if _spread(each) > SAME]
        self.moves, self.own = {name: moved}, {name}
        idle = not moved and _spread(np.concatenate([r.violation for r in self.searched])) <= SAME
        return (Relevance({name: Effect(0.0, 0.0)}, Effect(0.0, 0.0), 0) if idle else everything), None, best

    def _compared(self, *points: FloatArray) -> "_Compared":
        """Roll the whole plan out for a few candidates."""
        rollout = self.objective.rollout(np.array(points))
        chosen = np.lexsort((-rollout.value, self.objective.missed(rollout)))[0]
        return _Compared(rollout, np.array(points), int(chosen))

    def _start(self, apart: FloatArray | None) -> FloatArray:
        """Return the point from which to search: the defaults, or where each action is the best on its own."""
        default = self.objective.space.default
        if apart is None or np.allclose(apart, default, rtol=1e-9):
            return default
        scores = self.objective(np.array([default, apart]))
        return (default, apart)[int(np.argmin(scores.ranks()))]

    def _relevance(self) -> Relevance:
        varying = len(self.objective.space.varying)
        affordable = int(_SCREENING * self.task.midlevel.evaluations / (4 * varying + 1))
        bases = int(np.clip(affordable, *_BASES))
        try:
            found = find_relevant(self.objective, self.objective.space, self.rng, bases=bases, tolerance=_TOLERANCE)
        except NothingFinite as error:
            raise self._not_finite(error) from error
        self.evaluations += found.evaluations
        self._note_moves(found)
        return found

    def _note_moves(self, found: Relevance) -> None:
        """Note what each variable moves in the population that was rolled out last."""
        assert self.objective.last is not None, "it has been rolled out"
        sampled = self.objective.last
        self.moves, self.own = {}, set()
        for measure, figures in sampled.figures.items():
            for name in found.moving(figures):
                self.moves.setdefault(name, []).append(measure)
        names = dict(zip(self.objective.keys, self.objective.space.names, strict=True))
        for instance in {instance for instance, _ in names}:
            felt = [c.violation for c in sampled.conditions if c.where == instance]
            felt += [figures for (owner, _), figures in sampled.figures.items() if owner == instance]
            moving = {name for figures in felt for name in found.moving(figures)}
            self.own |= {name for (owner, _), name in names.items() if owner == instance and name in moving}

    def _optimum(self, relevance: Relevance, start: FloatArray) -> Optimum:
        settings = self.task.midlevel
        part = self.objective.space.starting_at(start).only(relevance.relevant)
        left = max(1, settings.evaluations - self.evaluations)
        seconds = max(0.1, settings.seconds - (time.monotonic() - self.began))
        optimise = find_optimiser(settings.optimiser, batch=_BATCHES.get(settings.optimiser), quick=True)

        def told(milestone: tuple[int, float, float]) -> None:
            share = max(milestone[0] / left, (time.monotonic() - self.began) / settings.seconds)
            self.tell(min(share, 1.0), Milestone(*milestone))

        def evaluated(points: FloatArray) -> Scores:
            scores = self.objective(part.embed(points))
            if self.objective.last is not None:
                self.searched.append(self.objective.last)
            return scores

        self.searched = []
        try:
            optimum = optimise(evaluated, part, Budget(left, seconds), self.rng, told)
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
        self, compared: "_Compared", relevance: Relevance | None = None, apart: FloatArray | None = None
    ) -> RefinedPlan:
        rollout, point, chosen = compared.rollout, compared.points[compared.chosen], compared.chosen
        values = dict(zip(self.objective.keys, point.tolist(), strict=True))
        short = rollout.worst(chosen)
        margins = {(c.where, c.atom): float(c.margin[chosen]) for c in rollout.conditions}
        return RefinedPlan(
            plan=_with_values(self.plan, values),
            hyperparameters=self._tuned(point, relevance, apart),
            performance=tuple(self._performance(compared)),
            best=compared.value(chosen),
            defaults=compared.value(0),
            apart=None if apart is None else compared.value(-1),
            shortfall=None
            if short is None
            else Shortfall(short.where, short.atom, short.unit, margins[short.where, short.atom]),
            expected=margins,
            optimiser="",
            evaluations=self.evaluations + len(compared.points),
            seconds=time.monotonic() - self.began,
            stopped="",
            history=(),
        )

    def _tuned(self, point: FloatArray, relevance: Relevance | None, apart: FloatArray | None) -> tuple[Tuned, ...]:
        found = []
        for index, (key, variable) in enumerate(zip(self.objective.keys, self.objective.space.variables, strict=True)):
            status = "kept" if variable.lower < variable.upper else "fixed"
            if relevance is not None and status != "fixed":
                status = "optimised" if variable.name in relevance.relevant else "free"
            own = None if apart is None else float(apart[index])
            bounds = (variable.lower, variable.upper, variable.default)
            moves = tuple(self.moves.get(variable.name, ()))
            found.append(Tuned(*key, variable.unit, *bounds, float(point[index]), status, moves, own))
        return tuple(found)

    def _performance(self, compared: "_Compared") -> list[Performance]:
        figures = compared.rollout.figures
        return [
            Performance(i.name, m.name, m.unit, m.weight, m.scale, float(figures[i.name, m.name][compared.chosen]))
            for i in sorted(self.plan.instances, key=lambda i: (i.start, i.name))
            for m in self.task.domain.block_by_name[i.block].performance
        ]


def _spread(figures: FloatArray) -> float:
    finite = figures[np.isfinite(figures)]
    return float(np.ptp(finite)) if len(finite) else 0.0


def _with_values(plan: TaskPlan, values: dict[tuple[str, str], float]) -> TaskPlan:
    """Return the plan with these hyperparameters."""
    instances = []
    for instance in plan.instances:
        mine = {name: value for (owner, name), value in values.items() if owner == instance.name}
        instances.append(replace(instance, hyperparameters={**instance.hyperparameters, **mine}))
    return replace(plan, instances=tuple(instances))
