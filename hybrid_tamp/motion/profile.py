"""Profiles, which describe the progress of a movement along a given path or about a given axis.

A profile is the movement of a one-dimensional primitive from 0 to 1. The movement is sampled once and interpolated.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.motion.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Profile:
    """The travelled fraction of a movement as a function of normalised time. The movement starts and ends at rest.

    Attributes:
        primitive: one-dimensional primitive that moves from 0 to 1, with weights of shape ``(k, 1)``.
    """

    primitive: DMP

    def __post_init__(self) -> None:
        """Raise a ``ValueError`` if the primitive's weights do not have shape ``(k, 1)``."""
        if self.primitive.weights.ndim != 2 or self.primitive.weights.shape[1] != 1:
            raise ValueError(f"the weights of a profile must have shape (k, 1), got {self.primitive.weights.shape}")

    @cached_property
    def trajectory(self) -> Trajectory:
        """Movement in normalised time. After the movement and the settling time, the fraction is 1."""
        return self.primitive.trajectory([0.0], [1.0], 1.0)

    @cached_property
    def _table(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Normalised times, fractions and rates of the samples, each of shape ``(t,)``. The last rate is set to 0."""
        samples = self.trajectory.samples[:, :, 0].copy()
        samples[-1] = (1.0, 0.0, 0.0)
        time = np.asarray(np.arange(len(samples)) * self.trajectory.spacing, dtype=np.float64)
        return time, samples[:, 0], samples[:, 1]

    def share(self, phase: ArrayLike) -> FloatArray:
        """Return the travelled fraction of the movement from 0 to 1, shape ``(...)``.

        Args:
            phase: elapsed time divided by duration, shape ``(...)``. Settling ends at a phase greater than 1.
        """
        # A single table for the whole batch makes this function ten times as fast as `Trajectory.at`.
        time, share, _ = self._table
        return np.asarray(np.interp(np.asarray(phase, dtype=np.float64), time, share))

    def rate(self, phase: ArrayLike) -> FloatArray:
        """Return the derivative of the fraction with respect to the phase, shape ``(...)``.

        Args:
            phase: elapsed time divided by duration, shape ``(...)``. The derivative is 0 before and after the movement.
        """
        time, _, rate = self._table
        return np.asarray(np.interp(np.asarray(phase, dtype=np.float64), time, rate, left=0.0))

    def advance(
        self, elapsed: FloatArray, duration: FloatArray | float, amount: FloatArray | float = 1.0
    ) -> tuple[FloatArray, FloatArray]:
        """Return how far a movement has come, and how fast it is, each ``(...)``.

        Args:
            elapsed: time ``(...)`` [s] since the beginning of the movement, negative before the beginning.
            duration: duration ``(...)`` of the movement [s].
            amount: length ``(...)`` of the movement, e.g. in metres.
        """
        phase = elapsed / duration
        return amount * self.share(phase), amount * self.rate(phase) / duration

    def arrival(self, amount: ArrayLike, duration: ArrayLike, near: float, slow: float) -> FloatArray:
        """Return the time [s] after which a movement stays slow and close to its end, shape ``(...)``.

        Args:
            amount: length of the movement [m or rad], shape ``(...)``.
            duration: duration without the settling time [s], shape ``(...)``.
            near: largest distance from the end [m or rad].
            slow: largest speed [m/s or rad/s].
        """
        phase, share, rate = self._table
        far, time = np.abs(np.asarray(amount))[..., None], np.asarray(duration)[..., None]
        not_yet = (far * np.abs(1.0 - share) > near) | (far * np.abs(rate) / time > slow)
        # Index of the first sample after the last sample that is too far from the end or too fast.
        after = np.minimum(np.max(np.where(not_yet, np.arange(1, len(phase) + 1), 0), axis=-1), len(phase) - 1)
        return np.asarray(phase[after] * duration)
