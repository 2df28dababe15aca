"""Which hyperparameters matter at all: those without any effect keep their defaults and the search space shrinks.

An effect at one point says nothing about others, and a variable may act through an interaction only: so from base
points all over the space (a latin hypercube, and the default point) each variable is moved to both its bounds, to their
middle and to a random value with all others kept. These points of a line along the variable's axis are compared with
each other. A variable is free if the largest effect of all its lines is below tolerance, on the violation and on the
value.

The value counts where all conditions hold, because the violation comes first. Where hardly any such points are on a
variable's lines, it counts wherever the rollout did not fail: a variable of which little is known is kept. So is one
that makes the difference between a rollout that fails and one that does not.
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
"""With fewer lines than these on which two points meet all conditions, too little is known of the value there."""


class Effect(NamedTuple):
    """How much a variable changes the outcome at most, the others kept; inf where it makes a rollout fail."""

    violation: float
    value: float


@dataclass(frozen=True)
class Screening:
    """What matters.

    Attributes:
        effects: largest effects by the name of the variable, constants excepted.
        tolerance: effects up to these do not matter.
        evaluations: candidates that were evaluated.
        bases: base points among them.
    """

    effects: Mapping[str, Effect]
    tolerance: Effect
    evaluations: int
    bases: int = 0

    @property
    def relevant(self) -> tuple[str, ...]:
        """Names of the variables with an effect, in the order of the space."""
        return tuple(name for name in self.effects if name not in self.free)

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the variables without an effect, in the order of the space."""
        most = self.tolerance
        return tuple(
            name
            for name, effect in self.effects.items()
            if effect.violation <= most.violation and effect.value <= most.value
        )

    def find_moving(self, figures: FloatArray, tolerance: float = 2e-3) -> tuple[str, ...]:
        """Return the names of the variables that change a figure by more than this part of its spread.

        Args:
            figures: the figure of each candidate that was evaluated, shape ``(evaluations,)``; it counts where finite.
            tolerance: as a part of the spread over the sample.
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
    """Return which variables have an effect anywhere within their bounds; all points go in one batch.

    Args:
        evaluate: scores a batch of points.
        space: the variables, of which k are no constants.
        rng: source of the base points and of the random values.
        bases: base points, at least 1, the default included; ``bases * (4 k + 1)`` points are evaluated.
        tolerance: of the value, as a part of its spread over the sample (from the 5th to the 95th percentile, so that
            a few extreme rollouts do not hide the others); of the violation, absolute (it is scaled) or as a part of
            its spread where that exceeds 1.

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
    """Return the default and a latin hypercube in the unit cube, shape ``(n, k)``."""
    rows = np.tile(np.arange(n - 1), (len(default), 1))
    hypercube = (rng.permuted(rows, axis=1).T + rng.uniform(size=(n - 1, len(default)))) / max(1, n - 1)
    return np.vstack([default, hypercube])


def _moved(base: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return each base point with each variable in turn at each level, shape ``(n, k, levels, k)``."""
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
    """Return the largest difference between two figures of a line that count; 0 where there are no two."""
    high = np.max(np.where(counted, figures, -np.inf), axis=1)
    low = np.min(np.where(counted, figures, np.inf), axis=1)
    return max(0.0, float(np.max(high - low)))
