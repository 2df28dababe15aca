"""The last refinement: from the optimum that the forward models expect on, with a truer and dearer way to roll out.

What the forward models leave out shifts an optimum a little, so it is looked for nearby: as far as the forward models
see all conditions met, and not farther than a part of each range. The optimum itself is the first candidate, and of
equal ones it wins.
"""

import logging
import time
from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from hybrid_tamp.midlevel.objective import Evaluator, Objective
from hybrid_tamp.midlevel.optimiser import Budget, NothingFinite
from hybrid_tamp.midlevel.plan_search import Searched, SearchSettings
from hybrid_tamp.midlevel.registry import find_optimiser
from hybrid_tamp.midlevel.search_space import SearchSpace
from hybrid_tamp.model.refined import Milestone, Retuning, Shortfall, Value
from hybrid_tamp.motion.arrays import FloatArray

_logger = logging.getLogger(__name__)

_SHARE, _LEAST, _MOST = 50, 4, 40
"""One of so many evaluations of the budget is made in physics; so many at least, and at most."""
_REACH = 0.1
"""How far from the optimum a value may go, as a part of its range."""
_HALVINGS = 8


@dataclass(frozen=True)
class RefinedInPhysics:
    """What going on in physics found.

    Attributes:
        point: the best point ``(d,)``.
        shortfall: the first condition that is not met there, or None.
        retuning: what was done.
    """

    point: FloatArray
    shortfall: Shortfall | None
    retuning: Retuning


def refine_in_physics(
    settings: SearchSettings, searched: Searched, point: FloatArray, measured: Objective
) -> RefinedInPhysics:
    """Go on from a point by runs in physics.

    Args:
        settings: whose optimiser and whose budgets: of evaluations a share, of time as much again.
        searched: what was searched with the forward models.
        point: its optimum, shape ``(d,)``.
        measured: the objective by runs in physics. A run that is repeated scores the same, to the bit: to an optimiser
            that is not noise.
    """
    began, midlevel = time.monotonic(), settings.midlevel
    part = narrow_space(replace(searched.objective, until=None), point, searched.screening.relevant)
    budget = Budget(int(np.clip(midlevel.evaluations // _SHARE, _LEAST, _MOST)), midlevel.seconds)

    def tell(milestone: Milestone) -> None:
        settings.tell(min(1.0, milestone.evaluations / budget.evaluations), milestone)

    runs = Evaluator(measured, part)
    best, stopped, history = point, "every run failed", tuple[Milestone, ...]()
    try:
        optimum = find_optimiser(midlevel.optimiser)(runs, part, budget, settings.rng, tell)
        best, stopped, history = part.embed(optimum.point[None])[0], optimum.stopped, optimum.history
    except NothingFinite as error:
        _logger.warning("in physics %s", error)
    before, (value, shortfall) = _look_up(runs, point)[0], _look_up(runs, best)
    count = sum(len(points) for points, _ in runs.batches)
    return RefinedInPhysics(best, shortfall, Retuning(before, value, count, time.monotonic() - began, stopped, history))


def _look_up(runs: Evaluator, point: FloatArray) -> tuple[Value, Shortfall | None]:
    """Return what came of a point that has been run."""
    points, run = next((points, run) for points, run in runs.batches if (points == point).all(axis=1).any())
    row = int(np.argmax((points == point).all(axis=1)))
    short = run.worst(row)
    return Value(float(run.violation[row]), float(run.value[row])), None if short is None else short.at(row)


def narrow_space(objective: Objective, point: FloatArray, names: Collection[str]) -> SearchSpace:
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
