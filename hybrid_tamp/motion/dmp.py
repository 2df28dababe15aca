"""Discrete dynamic movement primitives (DMPs), which consist of a spring to the goal and a learnt forcing term.

DMPs are from Ijspeert, Nakanishi and Schaal (NIPS 2003; reviewed in Ijspeert et al. 2013, Neural Computation
25:328-373). This module implements the form of Pastor et al. and Hoffmann et al. (both ICRA 2009). In this form, the
forcing term is not scaled by ``goal - start``, so start and goal can be equal along some or all axes. The equations of
the position y and the phase s in normalised time ``p = t / duration`` are::

    y'' = alpha beta (goal - y - soft_start s (goal - start) + f(s)) - alpha y',   y(0) = start,  y'(0) = 0
    s'  = -alpha_phase s,                                                          s(0) = 1
    f(s) = s sum_i psi_i(s) w_i / sum_i psi_i(s),   psi_i(s) = exp(-widths_i (s - centres_i)^2)

The spring is critically damped if ``alpha = 4 beta``. The forcing term f displaces the attractor, which is the point to
which the spring pulls. So f and the weights are in metres.
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
    """A discrete dynamic movement primitive. See the docstring of the module for the equations.

    Attributes:
        weights: displacements of the attractor [m], shape ``(k, d)``, or ``(..., k, d)`` for a batch of primitives.
        alpha: damping of the spring, per normalised time.
        beta: ratio of stiffness to damping, per normalised time. ``alpha / 4`` is critical damping.
        alpha_phase: decay rate of the phase s, per normalised time. With a rate of 10, s decays from 1 to 4.5e-5.
        soft_start: whether the pull to the goal grows from 0 while s decays (Hoffmann et al. 2009). If False, the
            acceleration starts at ``alpha beta (goal - start) / duration^2`` (Ijspeert et al. 2003).
    """

    weights: FloatArray
    alpha: float = 25.0
    beta: float = 6.25
    alpha_phase: float = 10.0
    soft_start: bool = False

    def __post_init__(self) -> None:
        """Raise a ``ValueError`` if an attribute is invalid."""
        if self.weights.ndim < 2 or 0 in self.weights.shape or not np.all(np.isfinite(self.weights)):
            raise ValueError(f"weights must be finite and of shape (..., k, d), got {self.weights.shape}")
        for name in ("alpha", "beta", "alpha_phase"):
            if not 0.0 < getattr(self, name) < np.inf:
                raise ValueError(f"{name} must be positive and finite, got {getattr(self, name)}")

    @property
    def system(self) -> TransformationSystem:
        """Spring and basis functions of the primitive, without the weights."""
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
        """Return a primitive whose weights are learnt from one or more demonstrations that start and end at rest.

        The weights are a least-squares fit to the positions, see :func:`~hybrid_tamp.motion.imitation.fitted_weights`.
        The demonstrations can have different starts, goals and durations.

        Args:
            time: times of the samples [s], shape ``(t,)``, or a sequence with one array for each demonstration.
            positions: positions [m], shape ``(t, d)``, or a sequence with one array for each demonstration.
            n_weights: number k of basis functions.
            soft_start: value of the attribute `soft_start`. For a goal that was not demonstrated, a soft start better
                preserves the initial part of the movement, e.g. lifting before travelling.

        Returns:
            The learnt primitive, with the default spring.

        Raises:
            ValueError: if a demonstration has fewer than 5 samples, if its times do not increase, if a value is not
                finite, if the shapes do not match, or if ``n_weights`` is not positive.
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
        """Return the movement of the primitive as a reference for a policy.

        Args:
            start: initial positions [m], shape ``(..., d)``. The initial velocity is zero.
            goal: final positions [m], shape ``(..., d)``.
            duration: durations without the settling time [s], shape ``(...)``.
            n_steps: number of time steps. The interpolation error is at most ``a (duration / n_steps)^2 / 8``, where
                ``a`` is the largest acceleration.
            settle: settling time after the movement, as a fraction of the duration.

        Returns:
            Sampled movement, with the broadcast batch shape ``(...)``.

        Raises:
            ValueError: if a duration or ``n_steps`` is not positive, if ``settle`` is negative, or if the shapes do
                not match.
        """
        begin, end, tau = (np.asarray(values, dtype=np.float64) for values in (start, goal, duration))
        if not np.all((tau > 0.0) & np.isfinite(tau)):
            raise ValueError(f"duration must be positive and finite, got {tau}")
        if n_steps < 1 or not 0.0 <= settle < np.inf:
            raise ValueError(f"n_steps must be at least 1 and settle must be at least 0, got {n_steps} and {settle}")
        d = self.weights.shape[-1]
        if {begin.shape[-1:], end.shape[-1:]} != {(d,)}:
            raise ValueError(f"start and goal must have shape (..., {d}), got {begin.shape} and {end.shape}")
        responses = settling_responses(self.system, n_steps, _steps(settle * n_steps))
        return Trajectory(tau, end, 1.0 / n_steps, self._samples(begin, end, responses))

    def _samples(self, start: FloatArray, goal: FloatArray, responses: FloatArray) -> FloatArray:
        """Return the samples ``(t, ..., 3, d)`` of the movement from the responses ``(t, 3, 1 + k)`` of the spring."""
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
        """Return the movement of the primitive as time series.

        All movements of a batch have the same grid in normalised time. The longest movement has the largest time step,
        which is at most ``dt`` and divides the duration of the longest movement.

        Args:
            start: initial positions [m], shape ``(..., d)``. The initial velocity is zero.
            goal: final positions [m], shape ``(..., d)``.
            duration: durations without the settling time [s], shape ``(...)``.
            dt: largest time step [s].
            settle: settling time after the movement, as a fraction of the duration.

        Returns:
            Times [s], positions [m] and velocities [m/s]. The times have shape ``(t,)``, or ``(t, ...)`` for a batch of
            durations. The positions and the velocities have the broadcast shape ``(t, ..., d)``.

        Raises:
            ValueError: if a duration or ``dt`` is not positive, if ``settle`` is negative, or if the shapes do not
                match.
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
    # Without the tolerance, a rounding error could add a step: 100.00000000000001 would become 101.
    return ceil(amount - 1e-9)
