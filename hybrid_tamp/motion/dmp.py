"""Discrete dynamic movement primitives: a spring to the goal with a learnt forcing term.

The primitive is that of Ijspeert, Nakanishi and Schaal (NIPS 2003; reviewed in Ijspeert et al. 2013, Neural
Computation 25:328-373), in the form of Pastor, Hoffmann, Asfour and Schaal and of Hoffmann, Pastor, Park and
Schaal (both ICRA 2009), whose forcing term is not scaled by ``goal - start``: start and goal may be equal, in
one axis or in all. In normalised time ``p = t / duration``::

    y'' = alpha beta (goal - y - soft_start s (goal - start) + f(s)) - alpha y',   y(0) = start,  y'(0) = 0
    s'  = -alpha_phase s,                                                          s(0) = 1
    f(s) = s sum_i psi_i(s) w_i / sum_i psi_i(s),   psi_i(s) = exp(-widths_i (s - centres_i)^2)

``alpha = 4 beta`` damps the spring critically. The forcing term f and the weights are in metres: f displaces
the point to which the spring pulls.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.imitation import SETTLE, checked_demonstrations, fitted_weights
from hybrid_tamp.motion.trajectory import Trajectory
from hybrid_tamp.motion.transformation_system import TransformationSystem, settling_responses


@dataclass(frozen=True, eq=False)
class DMP:
    """A discrete dynamic movement primitive; the docstring of the module has its equations.

    Attributes:
        weights: displacements of the attractor [m], shape ``(k, d)`` or, for a population that explores
            weights, ``(..., k, d)``.
        alpha: damping of the spring, per normalised time.
        beta: stiffness over damping, per normalised time; a quarter of ``alpha`` damps critically.
        alpha_phase: decay of the phase s, per normalised time; at 10, s ends at 4.5e-5.
        soft_start: whether the pull to the goal grows from 0 as s decays (Hoffmann et al. 2009). If not, the
            acceleration jumps at the beginning by ``alpha beta (goal - start) / duration^2`` (Ijspeert et al.
            2003), and zero weights give the plain spring.
    """

    weights: FloatArray
    alpha: float = 25.0
    beta: float = 6.25
    alpha_phase: float = 10.0
    soft_start: bool = False

    def __post_init__(self) -> None:
        """Raise a ``ValueError`` if a field is wrong."""
        if self.weights.ndim < 2 or 0 in self.weights.shape or not np.all(np.isfinite(self.weights)):
            raise ValueError(f"weights must be finite and of shape (..., k, d), got {self.weights.shape}")
        for name in ("alpha", "beta", "alpha_phase"):
            if not 0.0 < getattr(self, name) < np.inf:
                raise ValueError(f"{name} must be positive and finite, got {getattr(self, name)}")

    @property
    def system(self) -> TransformationSystem:
        """The spring and the basis, without the weights."""
        n_weights = self.weights.shape[-2]
        return TransformationSystem(n_weights, self.alpha, self.beta, self.alpha_phase, self.soft_start)

    @classmethod
    def imitate(
        cls,
        time: FloatArray | Sequence[FloatArray],
        positions: FloatArray | Sequence[FloatArray],
        n_weights: int = 20,
        *,
        soft_start: bool = True,
    ) -> "DMP":
        """Learn the weights from one or more demonstrations that begin and end at rest.

        The weights are the least-squares solution for the positions, see
        :func:`~hybrid_tamp.motion.imitation.fitted_weights`. Each demonstration has its own start, goal and
        duration.

        Args:
            time: times of the samples [s], shape ``(t,)``; or one such array per demonstration.
            positions: positions [m], shape ``(t, d)``; or one such array per demonstration.
            n_weights: number k of basis functions.
            soft_start: as the attribute; on by default, because it better keeps the shape of the beginning,
                such as lifting before travelling, for another goal.

        Returns:
            The primitive, with the default spring.

        Raises:
            ValueError: a demonstration has fewer than 5 samples, its time does not increase, a value is not
                finite or the shapes do not match; or ``n_weights`` is not positive.
        """
        if n_weights < 1:
            raise ValueError(f"n_weights must be at least 1, got {n_weights}")
        demonstrations = checked_demonstrations(time, positions)
        size = demonstrations[0][1].shape[1]
        blank = cls(np.zeros((n_weights, size)), soft_start=soft_start)
        return cls(fitted_weights(blank.system, demonstrations), soft_start=soft_start)

    def trajectory(
        self,
        start: ArrayLike,
        goal: ArrayLike,
        duration: ArrayLike,
        n_steps: int = 300,
        settle: float = SETTLE,
    ) -> Trajectory:
        """Return the movement as a reference for a policy.

        Args:
            start: initial positions, at rest [m], shape ``(..., d)``.
            goal: final positions [m], shape ``(..., d)``.
            duration: durations without settling [s], shape ``(...)``.
            n_steps: steps from 0 to the duration. Interpolating between them errs by at most the largest
                acceleration times ``(duration / n_steps)^2 / 8``.
            settle: settling time after the duration, as a part of the duration.

        Returns:
            The movement, of broadcast batch shape ``(...)``.

        Raises:
            ValueError: a duration or ``n_steps`` is not positive, ``settle`` is negative, or shapes do not
                match.
        """
        begin, end, tau = (np.asarray(values, dtype=np.float64) for values in (start, goal, duration))
        if not np.all((tau > 0.0) & np.isfinite(tau)):
            raise ValueError(f"duration must be positive and finite, got {tau}")
        if n_steps < 1 or not 0.0 <= settle < np.inf:
            raise ValueError(f"need n_steps of at least 1 and settle of at least 0, got {n_steps}, {settle}")
        d = self.weights.shape[-1]
        if {begin.shape[-1:], end.shape[-1:]} != {(d,)}:
            raise ValueError(f"start and goal must have shape (..., {d}), got {begin.shape} and {end.shape}")
        responses = settling_responses(self.system, n_steps, _steps(settle * n_steps))
        return Trajectory(tau, end, 1.0 / n_steps, self._samples(begin, end, responses))

    def _samples(self, start: FloatArray, goal: FloatArray, responses: FloatArray) -> FloatArray:
        """Return the sum of the responses ``(t, 3, 1 + k)``, weighted: ``(t, ..., 3, d)``."""
        n_weights, d = self.weights.shape[-2:]
        weight_batch = self.weights.shape[:-2]
        batch = np.broadcast_shapes(start.shape[:-1], goal.shape[:-1], weight_batch)
        pull = responses[..., 0].reshape(-1, *(1,) * len(batch), 3, 1)
        forced = responses[..., 1:].reshape(-1, n_weights) @ self.weights
        forced = np.moveaxis(forced.reshape(*weight_batch, -1, 3, d), -3, 0)
        forced = forced.reshape(-1, *(1,) * (len(batch) - len(weight_batch)), *forced.shape[1:])
        samples = pull * (goal - start)[..., None, :] + forced
        samples[..., 0, :] += start
        return samples

    def rollout(
        self, start: ArrayLike, goal: ArrayLike, duration: ArrayLike, dt: float, settle: float = SETTLE
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the movement as series in time.

        All members of a batch have the same number of samples, on one grid in normalised time; ``dt`` is the
        step of the longest, shortened so that it divides the duration.

        Args:
            start: initial positions, at rest [m], shape ``(..., d)``.
            goal: final positions [m], shape ``(..., d)``.
            duration: durations without settling [s], shape ``(...)``.
            dt: largest step [s].
            settle: settling time after the duration, as a part of the duration.

        Returns:
            Time [s], shape ``(t,)`` or, for a batch of durations, ``(t, ...)``; positions [m] and velocities
            [m/s], each of broadcast shape ``(t, ..., d)``.

        Raises:
            ValueError: a duration or ``dt`` is not positive, ``settle`` is negative, or shapes do not match.
        """
        if not 0.0 < dt < np.inf:
            raise ValueError(f"dt must be positive and finite, got {dt}")
        longest = float(np.max(np.asarray(duration, dtype=np.float64)))
        n_steps = max(1, _steps(longest / dt)) if np.isfinite(longest) else 1
        begin = np.asarray(start, dtype=np.float64)
        begin = np.broadcast_to(begin, np.broadcast_shapes(begin.shape, (*np.shape(duration), 1)))
        movement = self.trajectory(begin, goal, duration, n_steps, settle)
        normalised = np.arange(len(movement.samples)) / n_steps
        time = normalised.reshape(-1, *(1,) * movement.duration.ndim) * movement.duration
        velocities = movement.samples[..., 1, :] / movement.duration[..., None]
        return time, movement.samples[..., 0, :].copy(), velocities


def _steps(amount: float) -> int:
    # Rounding must not turn 100.00000000000001 into 101.
    return ceil(amount - 1e-9)
