"""Refinement in physics. A physics backend simulates candidates near the optimum of the forward models.

The forward models omit effects that shift the optimum slightly. So the search changes each variable by only a fraction
of its range. Within these narrow bounds, the models predict no additional violation. The optimum of the forward models
is the first candidate and wins ties.
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
"""The number of runs in physics is the budget of evaluations divided by `_SHARE`, clipped to `_LEAST` and `_MOST`."""
_REACH = 0.1
"""Largest distance of a value from the optimum, as a fraction of the variable's range."""
_HALVINGS = 8


@dataclass(frozen=True)
class RefinedInPhysics:
    """The result of refinement in physics.

    Attributes:
        point: best point. Shape ``(d,)``.
        shortfall: first condition that the best point violates, or None.
        retuning: summary of the search in physics.
    """

    point: FloatArray
    shortfall: Shortfall | None
    retuning: Retuning


def refine_in_physics(
    settings: SearchSettings, searched: Searched, point: FloatArray, measured: Objective
) -> RefinedInPhysics:
    """Search near a point. Candidates are scored by runs in physics.

    Args:
        settings: optimiser and budget. The number of runs in physics is proportional to the budget.
        searched: result of the search on the forward models.
        point: optimum on the forward models. Shape ``(d,)``.
        measured: objective that scores runs in physics. Repeated runs give bit-identical scores, so there is no noise.
    """
    began, midlevel = time.monotonic(), settings.midlevel
    part = narrow_space(replace(searched.objective, until=None), point, searched.screening.relevant)
    budget = Budget(int(np.clip(midlevel.evaluations // _SHARE, _LEAST, _MOST)))

    def tell(milestone: Milestone) -> None:
        settings.tell(min(1.0, milestone.evaluations / budget.evaluations), milestone)

    runs = Evaluator(measured, part)
    best, stopped, history = point, "every run failed", tuple[Milestone, ...]()
    try:
        optimum = find_optimiser(midlevel.optimiser)(runs, part, budget, settings.rng, tell)
        best, stopped, history = part.embed(optimum.point[None])[0], optimum.stopped, optimum.history
    except NothingFinite as error:
        _logger.warning("refinement in physics failed, so the optimum of the forward models is kept: %s", error)
    before, (value, shortfall) = _look_up(runs, point)[0], _look_up(runs, best)
    count = sum(len(points) for points, _ in runs.batches)
    return RefinedInPhysics(best, shortfall, Retuning(before, value, count, time.monotonic() - began, stopped, history))


def _look_up(runs: Evaluator, point: FloatArray) -> tuple[Value, Shortfall | None]:
    """Return the value and the shortfall of a point that was run before."""
    points, run = next((points, run) for points, run in runs.batches if (points == point).all(axis=1).any())
    row = int(np.argmax((points == point).all(axis=1)))
    short = run.worst(row)
    return Value(float(run.violation[row]), float(run.value[row])), None if short is None else short.at(row)


def narrow_space(objective: Objective, point: FloatArray, names: Collection[str]) -> SearchSpace:
    """Return a small space around a point, within which no change of a single variable increases the violation.

    The point has shape ``(d,)`` and becomes the default. The small space contains only the named variables.
    """
    space = objective.space
    columns = [index for index, name in enumerate(space.names) if name in names]
    steps = _REACH * 0.5 ** np.arange(_HALVINGS)[::-1]  # ascending
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
