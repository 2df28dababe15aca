"""Each action optimised on its own, in the order of the plan: what planning ahead is compared with.

An instance's own conditions and measures are all that counts, and what comes later is not looked at. Of choices that
are equally good the middle of their interval is taken.
"""

from collections.abc import Collection

import numpy as np

from hybrid_tamp.midlevel.objective import Objective
from hybrid_tamp.midlevel.optimiser import Evaluate
from hybrid_tamp.motion.arrays import FloatArray

_POINTS = 61
_SWEEPS = 2
_NARROWER = 0.05
"""Half of a sweep's range as a part of the one before: three points to either side of the best."""
_EQUAL = 1e-6
"""Difference of values, as a part of their spread over a scan, that counts as none."""


def optimise_apart(objective: Objective, relevant: Collection[str]) -> FloatArray:
    """Return the point ``(d,)`` at which each action is the best on its own.

    Args:
        objective: of the whole plan.
        relevant: the variables that are moved; the others keep their defaults.
    """
    point: FloatArray = objective.space.default.copy()
    for instance in sorted(objective.plan.instances, key=lambda i: (i.start, i.name)):
        mine = [
            index
            for index, (key, name) in enumerate(zip(objective.keys, objective.space.names, strict=True))
            if key[0] == instance.name and name in relevant
        ]
        # One variable after the other and all again, in a narrower range: one's best may depend on the others.
        for sweep in range(_SWEEPS):
            for index in mine:
                point[index] = _best(objective, objective.own(instance), point, index, _NARROWER**sweep)
    return point


def _best(objective: Objective, evaluate: Evaluate, point: FloatArray, index: int, share: float) -> float:
    """Return the middle of the best interval of one variable, within a share of its range, the others kept."""
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
