"""Trajectories, which are movements sampled in normalised time and used as references of policies."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A sampled movement that starts at rest and stays at the goal after its end.

    Attributes:
        duration: duration of the movement without the settling time [s], shape ``(...)``.
        goal: position after the last sample [m], shape ``(..., d)``.
        spacing: normalised time between two samples.
        samples: positions [m] and their first and second derivatives in normalised time [m], shape ``(t, ..., 3, d)``.
    """

    duration: FloatArray
    goal: FloatArray
    spacing: float
    samples: FloatArray

    @property
    def end(self) -> FloatArray:
        """Duration of the movement including the settling time [s], shape ``(...)``."""
        return np.asarray(self.duration * (self.spacing * (len(self.samples) - 1)))

    def at(self, elapsed: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the position, velocity and acceleration at a time. Each is linearly interpolated between samples.

        Args:
            elapsed: time since the start of the movement [s], shape ``(...)``. Negative times are treated as 0.

        Returns:
            Position [m], velocity [m/s] and acceleration [m/s^2], each with the broadcast shape ``(..., d)``. After
            :attr:`end`, the position is the goal, and the velocity and acceleration are 0.
        """
        batch = self.samples.shape[1:-2]
        now = np.asarray(elapsed, dtype=np.float64) / (self.duration * self.spacing)
        now = np.broadcast_to(now, np.broadcast_shapes(now.shape, batch))
        last = len(self.samples) - 1
        place = np.clip(now, 0.0, last)
        below = np.minimum(place.astype(np.intp), last - 1)
        # The open grid of indices lets each member of the batch read its own samples.
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
