"""The last refinement: a search near the optimum of the forward models, by rollouts that are more accurate and dearer.

The forward models leave out effects that shift the optimum a little. The search therefore stays near their optimum:
where they predict no further violation, and within a fraction of each range. Their optimum is the first candidate and
wins over equally good ones.
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
"""Evaluations of the budget for each run in physics; least and largest number of runs."""
_REACH = 0.1
"""Largest distance of a value from the optimum, as a fraction of its range."""
_HALVINGS = 8


@dataclass(frozen=True)
class RefinedInPhysics:
    """The result of refinement in physics.

    Attributes:
        point: the best point ``(d,)``.
        shortfall: the first condition that it does not meet, or None.
        retuning: the course of the search.
    """

    point: FloatArray
    shortfall: Shortfall | None
    retuning: Retuning


def refine_in_physics(
    settings: SearchSettings, searched: Searched, point: FloatArray, measured: Objective
) -> RefinedInPhysics:
    """Search near a point by runs in physics.

    Args:
        settings: the optimiser and the budgets: physics gets a share of the evaluations and the same time again.
        searched: the search with the forward models.
        point: its optimum, shape ``(d,)``.
        measured: the objective by runs in physics. Repeated runs score the same to the bit, so there is no noise.
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
    """Return the outcome of a point that has been run."""
    points, run = next((points, run) for points, run in runs.batches if (points == point).all(axis=1).any())
    row = int(np.argmax((points == point).all(axis=1)))
    short = run.worst(row)
    return Value(float(run.violation[row]), float(run.value[row])), None if short is None else short.at(row)


def narrow_space(objective: Objective, point: FloatArray, names: Collection[str]) -> SearchSpace:
    """Return the part of the space about a point in which each variable alone does not add to the violation.

    Args:
        objective: an objective with cheap rollouts.
        point: the default point ``(d,)`` of the part.
        names: the variables of the part.
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
