"""Screening of hyperparameters. Hyperparameters without an effect keep their defaults to shrink the search space.

The effect of a variable may differ from point to point and may depend on other variables. So screening uses base points
all over the space: the default point and a latin hypercube. From each base point, every variable is moved separately to
both of its bounds, to the midpoint of the bounds and to a random value. These points form a line along the variable's
axis. A variable is free if its effects on the violation and on the value are within tolerance on all lines.

Values are compared only at points that meet all conditions, because the violation takes precedence. If too few points
on the lines of a variable meet all conditions, values are compared at all points whose rollouts did not fail. A
variable that can make a rollout fail is never free.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hybrid_tamp.midlevel.optimiser import Evaluate, NothingFinite
from hybrid_tamp.midlevel.scores import SAME, BoolArray, Scores
from hybrid_tamp.midlevel.search_space import SearchSpace
from hybrid_tamp.motion.arrays import FloatArray

LEVELS = (0.0, 0.5, 1.0)
FEW = 4
"""Minimum number of lines with at least two points that meet all conditions. Else, all finite points are compared."""


class Effect(NamedTuple):
    """Largest changes of violation V and value J that one variable causes. If rollouts can fail, V changes by inf."""

    violation: float
    value: float


@dataclass(frozen=True)
class Screening:
    """The effects of the variables of a space.

    Attributes:
        effects: maps each variable that is not constant to its largest effects, in the order of the space.
        tolerance: largest negligible effects.
        evaluations: number of evaluated candidates, including the base points.
        bases: number of base points.
    """

    effects: Mapping[str, Effect]
    tolerance: Effect
    evaluations: int
    bases: int = 0

    @property
    def relevant(self) -> tuple[str, ...]:
        """Names of the variables with an effect above the tolerance."""
        return tuple(name for name in self.effects if name not in self.free)

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the variables without an effect above the tolerance."""
        most = self.tolerance
        return tuple(
            name
            for name, effect in self.effects.items()
            if effect.violation <= most.violation and effect.value <= most.value
        )

    def find_moving(self, figures: FloatArray, tolerance: float = 2e-3) -> tuple[str, ...]:
        """Return the names of the variables that change a figure by more than a fraction of its spread.

        Args:
            figures: figures of all evaluated candidates. Non-finite figures are ignored. Shape ``(evaluations,)``.
            tolerance: largest negligible change, as a fraction of the spread over the sample.
        """
        counted = np.isfinite(figures)
        if not counted.any():
            return ()
        least = tolerance * _spread(figures[counted])
        lines = _lines(figures, self.bases, len(self.effects))
        ranges = [_largest_range(lines[:, i], np.isfinite(lines[:, i])) for i in range(len(self.effects))]
        return tuple(name for name, size in zip(self.effects, ranges, strict=True) if size > max(least, SAME))


def screen_hyperparameters(
    evaluate: Evaluate, space: SearchSpace, rng: np.random.Generator, *, bases: int = 32, tolerance: float = 2e-3
) -> Screening:
    """Find the variables that have an effect anywhere within their bounds. All points are evaluated in one batch.

    Args:
        evaluate: function that returns the scores of a batch of points.
        space: the variables, k of which are not constant.
        rng: random generator for the base points and the random values.
        bases: number of base points including the default, at least 1. ``bases * (4 k + 1)`` points are evaluated.
        tolerance: largest negligible effect, as a fraction of the spread over all points. The spread is the difference
            between the 5th and the 95th percentile, so that extreme rollouts do not matter. The spread of the violation
            is taken to be at least 1.

    Raises:
        NothingFinite: if every rollout failed.
    """
    varying = space.only(space.varying)
    k = varying.d
    if k == 0:
        return Screening({}, Effect(tolerance, 0.0), 0)
    base = _bases(varying.to_unit(varying.default), bases, rng)
    cube = np.concatenate([base, _moved(base, rng).reshape(-1, k)])
    scores = evaluate(varying.embed(varying.from_unit(cube)))
    if not np.any(scores.finite):
        raise NothingFinite(len(cube))
    allowed = _allowed(scores, tolerance)
    violation, value = (_lines(figures, bases, k) for figures in (scores.violation, scores.value))
    effects = [_effect(violation[:, i], value[:, i], allowed.violation) for i in range(k)]
    return Screening(dict(zip(varying.names, effects, strict=True)), allowed, len(cube), bases)


def _bases(default: FloatArray, n: int, rng: np.random.Generator) -> FloatArray:
    """Return the default point and a latin hypercube of base points, in the unit cube. Shape ``(n, k)``."""
    rows = np.tile(np.arange(n - 1), (len(default), 1))
    hypercube = (rng.permuted(rows, axis=1).T + rng.uniform(size=(n - 1, len(default)))) / max(1, n - 1)
    return np.vstack([default, hypercube])


def _moved(base: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return each base point with each variable moved to each level. Shape ``(n, k, levels, k)``."""
    n, k = base.shape
    moved = np.tile(base[:, None, None, :], (1, k, len(LEVELS) + 1, 1))
    for i in range(k):
        moved[:, i, :-1, i] = LEVELS
        moved[:, i, -1, i] = rng.uniform(size=n)
    return moved


def _lines(figures: FloatArray, n: int, k: int) -> FloatArray:
    """Return the figures of the points on each line, base point first. Shape ``(n, k, 1 + levels)``."""
    base = np.broadcast_to(figures[:n, None, None], (n, k, 1))
    return np.concatenate([base, figures[n:].reshape(n, k, -1)], axis=2)


def _allowed(scores: Scores, tolerance: float) -> Effect:
    """Return the largest negligible effects."""
    violation = tolerance * max(1.0, _spread(scores.violation[scores.finite]))
    met = scores.violation <= violation
    values = scores.value[met if np.sum(met) > 1 else scores.finite]
    return Effect(violation, max(tolerance * _spread(values), SAME * float(np.max(np.abs(values)))))


def _spread(figures: FloatArray) -> float:
    low, high = np.quantile(figures, [0.05, 0.95])
    return float(high - low)


def _effect(violation: FloatArray, value: FloatArray, allowed: float) -> Effect:
    """Return the largest effect of a variable over its lines, from figures of shape ``(n, 1 + levels)``."""
    finite = np.isfinite(violation)
    met = violation <= allowed
    known = np.sum(np.sum(met, axis=1) > 1)
    fails = np.any(np.any(finite, axis=1) & ~np.all(finite, axis=1))
    return Effect(
        violation=np.inf if fails else _largest_range(violation, finite),
        value=_largest_range(value, met if known >= FEW else finite),
    )


def _largest_range(figures: FloatArray, counted: BoolArray) -> float:
    """Return the largest difference between two figures of the same line. Only `counted` figures are compared."""
    high = np.max(np.where(counted, figures, -np.inf), axis=1)
    low = np.min(np.where(counted, figures, np.inf), axis=1)
    return max(0.0, float(np.max(high - low)))
