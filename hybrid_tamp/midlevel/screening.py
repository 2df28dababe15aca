"""Screening of hyperparameters: those without any effect keep their defaults, so that the search space shrinks.

An effect at one point says nothing about other points, and a variable may act only through an interaction. Screening
therefore starts from base points all over the space: a latin hypercube and the default point. From each base point it
moves each variable to both bounds, to their middle and to a random value, and keeps all others. It compares the points
on this line along the variable's axis. A variable is free if the largest effect on all its lines is below tolerance,
both on the violation and on the value.

The violation comes first, so the value counts only at points that meet all conditions. If hardly any such points are
on a variable's lines, the value counts at every point whose rollout did not fail. A variable that decides whether a
rollout fails is never free.
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
"""Fewest lines with two points that meet all conditions from which the effect on the value is estimated there."""


class Effect(NamedTuple):
    """Largest change that a variable makes while the others keep their values; inf if it can make a rollout fail."""

    violation: float
    value: float


@dataclass(frozen=True)
class Screening:
    """The effects of the variables of a space.

    Attributes:
        effects: variable that is not constant to its largest effects, in the order of the space.
        tolerance: largest effects that do not matter.
        evaluations: number of candidates that were evaluated.
        bases: number of base points among them.
    """

    effects: Mapping[str, Effect]
    tolerance: Effect
    evaluations: int
    bases: int = 0

    @property
    def relevant(self) -> tuple[str, ...]:
        """Names of the variables with an effect."""
        return tuple(name for name in self.effects if name not in self.free)

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the variables without an effect."""
        most = self.tolerance
        return tuple(
            name
            for name, effect in self.effects.items()
            if effect.violation <= most.violation and effect.value <= most.value
        )

    def find_moving(self, figures: FloatArray, tolerance: float = 2e-3) -> tuple[str, ...]:
        """Return the names of the variables that change a figure by more than a fraction of its spread.

        Args:
            figures: the figure of each evaluated candidate, shape ``(evaluations,)``; figures that are not finite do
                not count.
            tolerance: fraction of the spread over the sample.
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
    """Find the variables that have an effect anywhere within their bounds; evaluate all points in one batch.

    Args:
        evaluate: scores a batch of points.
        space: the variables; k of them are not constant.
        rng: source of the base points and of the random values.
        bases: number of base points, at least 1, including the default; ``bases * (4 k + 1)`` points are evaluated.
        tolerance: largest effect that does not matter. For the value it is a fraction of the spread over the sample
            (from the 5th to the 95th percentile, so that a few extreme rollouts do not hide the others). For the
            violation it is absolute (violations are scaled), or a fraction of the spread if that exceeds 1.

    Raises:
        NothingFinite: every rollout failed.
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
    """Sample the base points in the unit cube, shape ``(n, k)``: the default and a latin hypercube."""
    rows = np.tile(np.arange(n - 1), (len(default), 1))
    hypercube = (rng.permuted(rows, axis=1).T + rng.uniform(size=(n - 1, len(default)))) / max(1, n - 1)
    return np.vstack([default, hypercube])


def _moved(base: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Move each variable of each base point to each level, shape ``(n, k, levels, k)``."""
    n, k = base.shape
    moved = np.tile(base[:, None, None, :], (1, k, len(LEVELS) + 1, 1))
    for i in range(k):
        moved[:, i, :-1, i] = LEVELS
        moved[:, i, -1, i] = rng.uniform(size=n)
    return moved


def _lines(figures: FloatArray, n: int, k: int) -> FloatArray:
    """Return the figures of the points on each line, shape ``(n, k, 1 + levels)``, the base point first."""
    base = np.broadcast_to(figures[:n, None, None], (n, k, 1))
    return np.concatenate([base, figures[n:].reshape(n, k, -1)], axis=2)


def _allowed(scores: Scores, tolerance: float) -> Effect:
    """Return the effects that do not matter."""
    violation = tolerance * max(1.0, _spread(scores.violation[scores.finite]))
    met = scores.violation <= violation
    values = scores.value[met if np.sum(met) > 1 else scores.finite]
    return Effect(violation, max(tolerance * _spread(values), SAME * float(np.max(np.abs(values)))))


def _spread(figures: FloatArray) -> float:
    low, high = np.quantile(figures, [0.05, 0.95])
    return float(high - low)


def _effect(violation: FloatArray, value: FloatArray, allowed: float) -> Effect:
    """Return the largest effect over lines, from figures of shape ``(n, 1 + levels)``."""
    finite = np.isfinite(violation)
    met = violation <= allowed
    known = np.sum(np.sum(met, axis=1) > 1)
    fails = np.any(np.any(finite, axis=1) & ~np.all(finite, axis=1))
    return Effect(
        violation=np.inf if fails else _largest_range(violation, finite),
        value=_largest_range(value, met if known >= FEW else finite),
    )


def _largest_range(figures: FloatArray, counted: BoolArray) -> float:
    """Return the largest difference between two figures of a line that count; 0 if fewer than two count."""
    high = np.max(np.where(counted, figures, -np.inf), axis=1)
    low = np.min(np.where(counted, figures, np.inf), axis=1)
    return max(0.0, float(np.max(high - low)))
