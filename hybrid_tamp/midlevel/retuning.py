"""The last refinement: from the optimum that the forward models expect on, with a truer and dearer way to roll out.

What the forward models leave out shifts an optimum a little, so it is looked for nearby: as far as the forward models
see all conditions met, and not farther than a part of each range. The optimum itself is the first candidate, and of
equal ones it wins.
"""

import logging
import time
from collections.abc import Callable, Collection
from dataclasses import dataclass, field, replace

import numpy as np

from hybrid_tamp.midlevel.objective import Objective
from hybrid_tamp.midlevel.optimiser import Budget, NothingFinite, find_optimiser
from hybrid_tamp.midlevel.rollout import Rollout
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.midlevel.search_space import SearchSpace
from hybrid_tamp.model.refined import Milestone, Retuning, Shortfall, Value
from hybrid_tamp.model.task import MidLevel
from hybrid_tamp.motion.arrays import FloatArray

Tell = Callable[[float, Milestone], None]

_logger = logging.getLogger(__name__)

_SHARE, _LEAST, _MOST = 50, 4, 40
"""One of so many evaluations of the budget is made in physics; so many at least, and at most."""
_REACH = 0.1
"""How far from the optimum a value may go, as a part of its range."""
_HALVINGS = 8


@dataclass
class Retuner:
    """The work on one plan.

    Attributes:
        expected: the objective by the forward models.
        measured: the objective by runs in physics. A run that is repeated scores the same, to the bit: to an optimiser
            that is not noise.
        settings: whose optimiser and whose budgets: of evaluations a share, of time as much again.
        rng: source of everything random.
        tell: told of the share of the budget that is spent, 0 to 1, and of the best so far.
    """

    expected: Objective
    measured: Objective
    settings: MidLevel
    rng: np.random.Generator
    tell: Tell
    _runs: list[tuple[FloatArray, Rollout]] = field(default_factory=list)

    def retune(self, point: FloatArray, names: Collection[str]) -> tuple[FloatArray, Shortfall | None, Retuning]:
        """Go on from a point.

        Args:
            point: the optimum of `expected`, shape ``(d,)``.
            names: the variables that matter.

        Returns:
            The best point ``(d,)``, the first condition that is not met there, and what was done.
        """
        began = time.monotonic()
        part = neighbourhood(self.expected, point, names)
        budget = Budget(int(np.clip(self.settings.evaluations // _SHARE, _LEAST, _MOST)), self.settings.seconds)
        optimise = find_optimiser(self.settings.optimiser)

        def told(milestone: tuple[int, float, float]) -> None:
            self.tell(min(1.0, milestone[0] / budget.evaluations), Milestone(*milestone))

        best, stopped, history = point, "every run failed", tuple[Milestone, ...]()
        try:
            optimum = optimise(lambda points: self._run(part.embed(points)), part, budget, self.rng, told)
            best, stopped = part.embed(optimum.point[None])[0], optimum.stopped
            history = tuple(Milestone(*each) for each in optimum.history)
        except NothingFinite as error:
            _logger.warning("in physics %s", error)
        before, (value, shortfall) = self._found(point)[0], self._found(best)
        count = sum(len(points) for points, _ in self._runs)
        return best, shortfall, Retuning(before, value, count, time.monotonic() - began, stopped, history)

    def _run(self, points: FloatArray) -> Scores:
        scores = self.measured(points)
        assert self.measured.last is not None, "it has just been rolled out"
        self._runs.append((points, self.measured.last))
        return scores

    def _found(self, point: FloatArray) -> tuple[Value, Shortfall | None]:
        """Return what came of a point that has been run."""
        points, run = next((points, run) for points, run in self._runs if (points == point).all(axis=1).any())
        row = int(np.argmax((points == point).all(axis=1)))
        short = run.worst(row)
        value = Value(float(run.violation[row]), float(run.value[row]))
        if short is None:
            return value, None
        return value, Shortfall(short.where, short.atom, short.unit, float(short.margin[row]))


def neighbourhood(objective: Objective, point: FloatArray, names: Collection[str]) -> SearchSpace:
    """Return a part of the space about a point, in which each variable alone does not add to the violation.

    Args:
        objective: of cheap rollouts.
        point: the point ``(d,)``, in which it has its default.
        names: the variables that vary in it.
    """
    space = objective.space
    columns = [index for index, name in enumerate(space.names) if name in names]
    steps = _REACH * 0.5 ** np.arange(_HALVINGS)[::-1]  # from small to large
    reaches = np.stack([-steps, steps])[:, None] * (space.upper - space.lower)[columns][None, :, None]
    moved = np.tile(point, (*reaches.shape, 1))  # (2, k, halvings, d)
    for row, column in enumerate(columns):
        moved[:, row, :, column] = np.clip(point[column] + reaches[:, row], space.lower[column], space.upper[column])
    violation = objective(np.vstack([point, moved.reshape(-1, space.d)])).violation
    met = np.logical_and.accumulate(violation[1:].reshape(reaches.shape) <= violation[0], axis=-1).sum(axis=-1)
    variables = [replace(each, default=float(at)) for each, at in zip(space.variables, point, strict=True)]
    for row, column in enumerate(columns):
        low, high = (
            float(moved[side, row, met[side, row] - 1, column]) if met[side, row] else float(point[column])
            for side in (0, 1)
        )
        variables[column] = replace(variables[column], lower=low, upper=high)
    return SearchSpace(tuple(variables)).only(names)
