"""Search over a single variable on nested grids. Each grid is one batch, and surrounds the best candidate so far.

A batch costs almost the same for 10 and for 100 candidates, so few large batches are cheaper than many small ones. The
spacing of the third grid is 1/13,500 of the range. If the action is also optimised on its own, the same batches contain
the points of this scan. All rollouts cover the whole plan and are kept, so no candidate is rolled out twice.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from hybrid_tamp.midlevel.action_by_action import SWEEPS, choose_midpoint, scan_points
from hybrid_tamp.midlevel.measured import merge_rollouts
from hybrid_tamp.midlevel.objective import Objective
from hybrid_tamp.midlevel.optimiser import Budget, Optimum, Search
from hybrid_tamp.midlevel.predictions import Rollout
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.model.refined import Milestone
from hybrid_tamp.motion.arrays import FloatArray

COUNTS = (61, 31, 31)
"""Number of candidates of each grid."""


@dataclass
class Rolled:
    """Scoring function for the points of a line, which keeps all rollouts.

    Attributes:
        objective: the objective. If its reserves are unknown, the first candidate determines them.
        rollouts: rollouts of all batches.
        further: points ``(m, d)`` that the next batch also contains, although they are no candidates of the search.
    """

    objective: Objective
    rollouts: list[Rollout] = field(default_factory=list)
    further: FloatArray | None = None
    _places: dict[bytes, tuple[int, int]] = field(default_factory=dict)

    def __call__(self, points: FloatArray) -> Scores:
        """Roll out points of the line, shape ``(n, 1)``, and the further points. Return the scores of the former."""
        space = self.objective.space
        wanted = space.only(space.varying).embed(points)
        self.roll_out(wanted if self.further is None else np.vstack([wanted, self.further]))
        return self.objective.score(self.look_up(wanted))

    def roll_out(self, points: FloatArray) -> None:
        """Roll out those points of shape ``(n, d)`` that were not rolled out before."""
        new = [row for row in {row.tobytes(): row for row in points}.values() if row.tobytes() not in self._places]
        if new:
            rollout = self.objective.rollout(np.array(new))
            self._places |= {row.tobytes(): (len(self.rollouts), place) for place, row in enumerate(new)}
            self.rollouts.append(rollout)
            if self.objective.reserves is None:
                self.objective = self.objective.keep_reserves(rollout)

    @property
    def count(self) -> int:
        """Number of points that were rolled out."""
        return len(self._places)

    def knows(self, point: FloatArray) -> bool:
        """Return whether a point ``(d,)`` was rolled out before."""
        return point.tobytes() in self._places

    def look_up(self, points: FloatArray) -> Rollout:
        """Return the rollout of points ``(n, d)`` that were rolled out before."""
        places = (self._places[row.tobytes()] for row in points)
        return merge_rollouts([self.rollouts[batch].pick(place) for batch, place in places])


def search_line(
    rolled: Rolled, budget: Budget, tell: Callable[[Milestone], None], apart: bool
) -> tuple[Optimum, FloatArray | None]:
    """Search over the only variable of a space that is not constant.

    Args:
        rolled: scoring function, which keeps the rollouts.
        budget: limit of the search. The scan of an action on its own does not count.
        tell: progress callback, called after each batch.
        apart: whether to also optimise the action of the variable on its own.

    Returns:
        The best point of the search, as a point of the space, and, if requested, the point ``(d,)`` that results from
        optimising the action on its own.

    Raises:
        NothingFinite: if every rollout failed.
    """
    space = rolled.objective.space
    (name,) = space.varying
    index, part = space.names.index(name), space.only([name])
    search = Search(rolled, part, budget, tell)
    point, (low, high) = space.default, (0.0, 1.0)
    for step, count in enumerate(_counts(budget)):
        rolled.further = scan_points(space, point, index, step) if apart else None
        if count:
            search.evaluate(np.linspace(low, high, count)[:, None])
            reach, at = (high - low) / max(count - 1, 1), float(part.to_unit(search.find_best("").point)[0])
            low, high = max(at - reach, 0.0), min(at + reach, 1.0)
        elif rolled.further is not None:
            rolled.roll_out(rolled.further)
        if rolled.further is not None and step < SWEEPS:
            point = _choose_apart(rolled, rolled.further, point, index)
    optimum = search.find_best(search.spent or "converged")
    return replace(optimum, point=part.embed(optimum.point[None])[0]), point if apart else None


def _counts(budget: Budget) -> tuple[int, ...]:
    """Return the number of candidates of each grid, without the default. A small budget is halved for each grid."""
    left = budget.evaluations - 1
    if left >= sum(COUNTS):
        return COUNTS
    first, second = (left + 1) // 2, (left // 2 + 1) // 2
    return max(first, 1), second, left - first - second


def _choose_apart(rolled: Rolled, points: FloatArray, point: FloatArray, index: int) -> FloatArray:
    """Return a point ``(d,)`` with the best value of its variable for the action on its own, from scanned points."""
    objective = rolled.objective
    owner = next(i for i in objective.plan.instances if i.name == objective.keys[index][0])
    scores = objective.score_instance(rolled.look_up(points), owner)
    chosen: FloatArray = point.copy()
    chosen[index] = choose_midpoint(points[:, index], scores, float(point[index]))
    return chosen
