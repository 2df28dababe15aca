"""A movement sampled in normalised time, the reference of a policy."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A movement from rest to rest and the position it holds afterwards.

    Attributes:
        duration: duration of the movement without settling [s], shape ``(...)``.
        goal: position held after the last sample [m], shape ``(..., d)``.
        spacing: normalised time between two samples.
        samples: position [m] and its first and second derivatives in normalised time [m], shape
            ``(t, ..., 3, d)``.
    """

    duration: FloatArray
    goal: FloatArray
    spacing: float
    samples: FloatArray

    @property
    def end(self) -> FloatArray:
        """Time from which the goal is held, settling included [s], shape ``(...)``."""
        return np.asarray(self.duration * (self.spacing * (len(self.samples) - 1)))

    def at(self, elapsed: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Read the reference, each quantity by linear interpolation of its own exact samples.

        Args:
            elapsed: time since the beginning [s], shape ``(...)``; before 0 it counts as 0.

        Returns:
            Position [m], velocity [m/s] and acceleration [m/s^2], each of broadcast shape ``(..., d)``; from
            :attr:`end` on, the goal, 0 and 0.
        """
        batch = self.samples.shape[1:-2]
        now = np.asarray(elapsed, dtype=np.float64) / (self.duration * self.spacing)
        now = np.broadcast_to(now, np.broadcast_shapes(now.shape, batch))
        last = len(self.samples) - 1
        place = np.clip(now, 0.0, last)
        below = np.minimum(place.astype(np.intp), last - 1)
        # An open grid over the batch lets each member read its own samples.
        members = np.indices(batch, sparse=True)
        at_lower, at_upper = (below, *members), (below + 1, *members)
        lower, upper = self.samples[at_lower], self.samples[at_upper]
        mixed = lower + (place - below)[..., None, None] * (upper - lower)
        moving = (place < last)[..., None]
        per_second = 1.0 / self.duration[..., None]
        return (
            np.where(moving, mixed[..., 0, :], self.goal),
            np.where(moving, mixed[..., 1, :] * per_second, 0.0),
            np.where(moving, mixed[..., 2, :] * per_second**2, 0.0),
        )
