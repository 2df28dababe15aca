"""Separate optimisation of each action, in the order of the plan, as a baseline for the joint optimisation.

Each action is scored only by its own conditions and measures. If all values of an interval are equally good, the
midpoint of the interval is chosen.
"""

from collections.abc import Collection

import numpy as np

from hybrid_tamp.midlevel.objective import Objective
from hybrid_tamp.midlevel.scores import Scores
from hybrid_tamp.midlevel.search_space import SearchSpace
from hybrid_tamp.motion.arrays import FloatArray

POINTS = 61
"""Number of points of a scan."""
SWEEPS = 2
"""Number of scans of each variable."""
_NARROWER = 0.05
"""Half-width of the range scanned in the second sweep, as a fraction of the first range. Equal to three grid steps."""
_EQUAL = 1e-6
"""Values that differ by at most this fraction of their spread over a scan are treated as equal."""


def optimise_apart(objective: Objective, relevant: Collection[str]) -> FloatArray:
    """Optimise each action separately, and return the resulting point. Shape ``(d,)``.

    Variables that are not named in `relevant` keep their defaults.
    """
    point: FloatArray = objective.space.default.copy()
    for instance in sorted(objective.plan.instances, key=lambda i: (i.start, i.name)):
        mine = [
            index
            for index, (key, name) in enumerate(zip(objective.keys, objective.space.names, strict=True))
            if key[0] == instance.name and name in relevant
        ]
        # The best value of each variable depends on the others, so a second sweep repeats the scans in narrower ranges.
        for sweep in range(SWEEPS):
            for index in mine:
                points = scan_points(objective.space, point, index, sweep)
                rollout = objective.rollout(points, instance.name)
                scores = objective.score_instance(rollout, instance)
                point[index] = choose_midpoint(points[:, index], scores, float(point[index]))
    return point


def scan_points(space: SearchSpace, point: FloatArray, index: int, sweep: int) -> FloatArray:
    """Return the points ``(n, d)`` at which a sweep scans one variable. After the last sweep, return only the point.

    Args:
        space: the search space.
        point: values of all variables ``(d,)``.
        index: index of the scanned variable.
        sweep: number of the sweep, starting with 0. The first sweep scans the whole range.
    """
    if sweep >= SWEEPS:
        return point[None]
    low, high = 0.0, 1.0
    if sweep > 0:
        at, half = float(space.to_unit(point)[index]), _NARROWER**sweep
        low, high = max(at - half, low), min(at + half, high)
    cube = np.tile(space.to_unit(point), (POINTS, 1))
    cube[:, index] = np.linspace(low, high, POINTS)
    points = np.tile(point, (POINTS, 1))
    points[:, index] = space.from_unit(cube)[:, index]
    return points


def choose_midpoint(values: FloatArray, scores: Scores, otherwise: float) -> float:
    """Return the midpoint of the best interval of a scan. If every rollout failed, return `otherwise`.

    Args:
        values: values of the scanned variable, in ascending order. Shape ``(n,)``.
        scores: scores of the values.
        otherwise: value for a scan without a finite score.
    """
    least = np.min(scores.violation)
    if not np.isfinite(least):
        return otherwise
    met = scores.violation <= least
    spread = float(np.ptp(scores.value[met]))
    best = met & (scores.value >= np.max(scores.value[met]) - _EQUAL * spread)
    first = int(np.argmax(best))
    last = first + int(np.argmin(np.append(best[first:], False))) - 1
    return float((values[first] + values[last]) / 2)
