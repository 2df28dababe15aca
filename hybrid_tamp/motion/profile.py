"""A profile: the progress of a movement along a given path or about a given axis.

It is the movement of a one-dimensional primitive from 0 to 1, evaluated once and read by interpolation.
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
    """The travelled share of the way over normalised time, from rest to rest.

    Attributes:
        primitive: a one-dimensional primitive, which moves from 0 to 1; weights of shape ``(k, 1)``.
    """

    primitive: DMP

    def __post_init__(self) -> None:
        """Raise a ``ValueError`` if the primitive's weights have another shape."""
        if self.primitive.weights.ndim != 2 or self.primitive.weights.shape[1] != 1:
            raise ValueError(f"a profile needs weights of shape (k, 1), got {self.primitive.weights.shape}")

    @cached_property
    def trajectory(self) -> Trajectory:
        """The movement in normalised time; after its end, settling included, the share is 1."""
        return self.primitive.trajectory([0.0], [1.0], 1.0)

    @cached_property
    def _table(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Normalised time, share and rate of every sample ``(t,)``; the last one is at rest on the goal."""
        samples = self.trajectory.samples[:, :, 0].copy()
        samples[-1] = (1.0, 0.0, 0.0)
        time = np.asarray(np.arange(len(samples)) * self.trajectory.spacing, dtype=np.float64)
        return time, samples[:, 0], samples[:, 1]

    def share(self, phase: ArrayLike) -> FloatArray:
        """Return the travelled share of the way, from 0 to 1.

        Args:
            phase: elapsed time over duration, shape ``(...)``; settling ends a little after 1.
        """
        # One table for a whole batch makes this ten times as fast as `Trajectory.at`.
        time, share, _ = self._table
        return np.asarray(np.interp(np.asarray(phase, dtype=np.float64), time, share))

    def rate(self, phase: ArrayLike) -> FloatArray:
        """Return the derivative of the share by the phase, shape ``(...)``; 0 before the beginning and after the end.

        Args:
            phase: elapsed time over duration, shape ``(...)``.
        """
        time, _, rate = self._table
        return np.asarray(np.interp(np.asarray(phase, dtype=np.float64), time, rate, left=0.0))

    def arrival(self, amount: ArrayLike, duration: ArrayLike, near: float, slow: float) -> FloatArray:
        """Return the time from which a movement stays near its end and slow, as exit conditions require, ``(...)`` [s].

        Args:
            amount: length of the movement, ``(...)`` [m or rad].
            duration: duration without settling, ``(...)`` [s].
            near: largest distance from the end [m or rad].
            slow: largest speed [m/s or rad/s].
        """
        phase, share, rate = self._table
        far, time = np.abs(np.asarray(amount))[..., None], np.asarray(duration)[..., None]
        not_yet = (far * np.abs(1.0 - share) > near) | (far * np.abs(rate) / time > slow)
        # The sample after the last one that is too far or too fast.
        after = np.minimum(np.max(np.where(not_yet, np.arange(1, len(phase) + 1), 0), axis=-1), len(phase) - 1)
        return np.asarray(phase[after] * duration)
