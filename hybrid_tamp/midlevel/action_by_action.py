"""Separate optimisation of each action, in the order of the plan, as a baseline for the joint optimisation.

Each action is scored only by its own conditions and measures. If all values of an interval are equally good, the
midpoint of the interval is chosen.
"""

from collections.abc import Collection

import numpy as np

from hybrid_tamp.midlevel.objective import Objective
from hybrid_tamp.midlevel.optimiser import Evaluate
from hybrid_tamp.motion.arrays import FloatArray

_POINTS = 61
_SWEEPS = 2
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
        for sweep in range(_SWEEPS):
            for index in mine:
                point[index] = _scan(objective, objective.restrict_to(instance), point, index, _NARROWER**sweep)
    return point


def _scan(objective: Objective, evaluate: Evaluate, point: FloatArray, index: int, share: float) -> float:
    """Scan one variable, up to a share of its range away from the point. Return the midpoint of its best interval."""
    lower, upper = objective.space.lower[index], objective.space.upper[index]
    low, high = lower, upper
    if share < 1.0:
        half = share * (upper - lower)
        low, high = max(point[index] - half, lower), min(point[index] + half, upper)
    values = np.linspace(low, high, _POINTS)
    points = np.tile(point, (_POINTS, 1))
    points[:, index] = values
    scores = evaluate(points)
    least = np.min(scores.violation)
    if not np.isfinite(least):
        return float(point[index])
    met = scores.violation <= least
    spread = float(np.ptp(scores.value[met]))
    best = met & (scores.value >= np.max(scores.value[met]) - _EQUAL * spread)
    first = int(np.argmax(best))
    last = first + int(np.argmin(np.append(best[first:], False))) - 1
    return float((values[first] + values[last]) / 2)
