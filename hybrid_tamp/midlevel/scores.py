"""Scores of candidates, ordered by violation first and by value second."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.motion.arrays import FloatArray

IntArray = NDArray[np.int_]
BoolArray = NDArray[np.bool_]

SAME = 1e-12
"""Largest relative difference between two figures that is treated as a rounding error."""


@dataclass(frozen=True, eq=False)
class Scores:
    """Violation and value of n candidates.

    A candidate is better than another if its violation is smaller or, at equal violations, its value is larger. If the
    violation or the value is NaN or infinite, the rollout failed. A failed rollout is stored with violation inf and
    value -inf, so that it ranks last.

    Attributes:
        violation: violation V, which is 0 if all conditions hold. Shape ``(n,)``.
        value: value J, which is the weighted sum of the performance measures. Shape ``(n,)``.

    Raises:
        ValueError: if the arrays differ in length, or if a violation is negative.
    """

    violation: FloatArray
    value: FloatArray

    def __post_init__(self) -> None:
        """Check the arrays, and mark failed rollouts in both."""
        violation, value = (np.asarray(each, dtype=np.float64) for each in (self.violation, self.value))
        if violation.ndim != 1 or violation.shape != value.shape:
            raise ValueError(f"violation and value must both have shape (n,), got {violation.shape} and {value.shape}")
        if np.any(violation < 0.0):
            raise ValueError(f"a violation must not be negative, got {np.nanmin(violation)}")
        finite = np.isfinite(violation) & np.isfinite(value)
        object.__setattr__(self, "violation", np.where(finite, violation, np.inf))
        object.__setattr__(self, "value", np.where(finite, value, -np.inf))

    @classmethod
    def join(cls, several: Iterable["Scores"]) -> "Scores":
        """Concatenate the scores of one or more populations."""
        each = tuple(several)
        return cls(*(np.concatenate([getattr(scores, name) for scores in each]) for name in ("violation", "value")))

    def __len__(self) -> int:
        return len(self.violation)

    def __getitem__(self, part: slice) -> "Scores":
        return Scores(self.violation[part], self.value[part])

    @property
    def finite(self) -> BoolArray:
        """Mask of the rollouts that did not fail. Shape ``(n,)``."""
        return np.isfinite(self.violation)

    def ranks(self) -> IntArray:
        """Return the rank of each candidate, starting with 0 for the best. Equal candidates share a rank."""
        order = np.lexsort((-self.value, self.violation))
        violation, value = self.violation[order], self.value[order]
        worse = (violation[1:] != violation[:-1]) | (value[1:] != value[:-1])
        ranks = np.zeros(len(self), dtype=np.int_)
        ranks[order[1:]] = np.cumsum(worse)
        return ranks

    def best(self) -> BoolArray:
        """Return a mask of the candidates that are best up to rounding errors. Shape ``(n,)``.

        If all rollouts failed, all candidates are best. A violation above 0 is never rounded to 0.
        """
        least = np.min(self.violation)
        if not np.isfinite(least):
            return np.ones(len(self), dtype=np.bool_)
        met = self.violation <= least * (1.0 + SAME)
        highest = np.max(self.value[met])
        return np.asarray(met & (self.value >= highest - SAME * max(1.0, abs(highest))))
