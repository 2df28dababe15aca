"""The transformation system of a movement primitive. The system is a damped spring that responds to inputs.

The spring is linear, so a movement is a weighted sum of the spring's responses to a few inputs. The responses are
computed once for each time grid and cached. The rollout of a whole batch is then a single matrix product. See
:mod:`hybrid_tamp.motion.dmp` for the equations.
"""

from functools import lru_cache
from math import ceil
from typing import NamedTuple

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.minimum_jerk import minimum_jerk, minimum_jerk_acceleration, minimum_jerk_rate


class TransformationSystem(NamedTuple):
    """The spring, the canonical system and the basis functions, without start, goal and weights.

    Attributes:
        n_weights: number k of basis functions.
        alpha: damping, per normalised time.
        beta: ratio of stiffness to damping, per normalised time.
        alpha_phase: decay rate of the phase s, per normalised time.
        soft_start: whether the pull towards the goal grows while s decays.
    """

    n_weights: int
    alpha: float
    beta: float
    alpha_phase: float
    soft_start: bool

    def centres(self) -> FloatArray:
        """Return the centres of the basis functions in s, shape ``(k,)`` (Ijspeert et al. 2013, Sec. 2.1.2)."""
        # The centres are equally spaced in time, so they form a geometric series in s.
        return np.asarray(np.exp(-self.alpha_phase * np.linspace(0.0, 1.0, self.n_weights)))

    def widths(self) -> FloatArray:
        """Return the factor of ``(s - centre)^2`` in the exponent of each basis function, shape ``(k,)``."""
        # The value of a basis function at the neighbouring centre is 1 / e.
        gaps = -np.diff(self.centres()) if self.n_weights > 1 else np.ones(1)
        return np.asarray(np.append(gaps, gaps[-1])[: self.n_weights] ** -2.0)

    def inputs(self, times: FloatArray) -> FloatArray:
        """Return the inputs 1, s and ``s psi_i / sum psi`` of the spring (Ijspeert et al. 2013, Eq. 2.3).

        Args:
            times: normalised times, shape ``(...)``.

        Returns:
            Displacements of the attractor for unit weights, shape ``(..., 2 + k)``.
        """
        s = np.exp(-self.alpha_phase * times)[..., None]
        exponents = -self.widths() * (s - self.centres()) ** 2
        # The exponents are relative to the largest exponent, so that the sum does not vanish beyond the last centre.
        psi = np.exp(exponents - np.max(exponents, axis=-1, keepdims=True))
        psi *= s / np.sum(psi, axis=-1, keepdims=True)
        return np.concatenate([np.ones_like(s), s, psi], axis=-1)

    def transition(self, steps: FloatArray) -> FloatArray:
        """Return the matrices that advance the state ``(y, y')`` by a step without input (matrix exponentials).

        Args:
            steps: lengths of the steps in normalised time, shape ``(...)``.

        Returns:
            Transition matrices, shape ``(..., 2, 2)``.
        """
        stiffness = self.alpha * self.beta
        # After the mean decay is factored out, the square of the system matrix is a multiple of the identity. So the
        # exponential consists of cosh and sinh of a root. The root is 0 for critical damping and imaginary for weak
        # damping.
        rest = np.array([[0.5 * self.alpha, 1.0], [-stiffness, -0.5 * self.alpha]])
        root = np.sqrt(complex(0.25 * self.alpha**2 - stiffness))
        even = np.cosh(root * steps).real
        odd = (np.sinh(root * steps) / root).real if root != 0.0 else steps
        decay = np.exp(-0.5 * self.alpha * steps)
        return np.asarray((decay * even)[..., None, None] * np.eye(2) + (decay * odd)[..., None, None] * rest)

    def driven(self, begins: FloatArray, steps: FloatArray) -> FloatArray:
        """Return the states to which each input moves the spring in short steps from rest.

        Args:
            begins: normalised times at which the steps start, shape ``(n,)``.
            steps: lengths of the steps in normalised time, shape ``(n,)``.

        Returns:
            Positions and first derivatives at the end of each step, for each input, shape ``(n, 2, 2 + k)``.
        """
        # The exact impulse response is integrated by Gauss-Legendre quadrature of order 8.
        abscissas, weights = np.polynomial.legendre.leggauss(4)
        offsets = steps[:, None] * (0.5 * abscissas + 0.5)
        impulses = self.alpha * self.beta * self.transition(steps[:, None] - offsets)[..., 1]
        weighted = (0.5 * steps[:, None] * weights)[..., None] * impulses
        return np.asarray(np.swapaxes(weighted, 1, 2) @ self.inputs(begins[:, None] + offsets))

    def responses_to_inputs(self, times: FloatArray) -> FloatArray:
        """Return the spring's response to each input. The spring starts at rest at position 0.

        Args:
            times: normalised times, not negative, shape ``(t,)``.

        Returns:
            Positions and their first and second derivatives, shape ``(t, 3, 2 + k)``.
        """
        # The spring is first simulated at the nodes, which are equally spaced times. The spacing is small compared with
        # the basis functions and the time constants, and does not depend on `times`. A last step leads from a node to
        # each requested time. So the response at a time is the same for all time grids.
        density = max(8 * self.n_weights, ceil(4.0 * max(self.alpha, self.beta, self.alpha_phase)))
        nodes = np.arange(ceil(density * np.max(times)) + 1) / density
        steps = np.full(len(nodes), 1.0 / density)
        at_nodes = np.zeros((len(nodes), 2, 2 + self.n_weights))
        transition = self.transition(steps[0])
        for n, gain in enumerate(self.driven(nodes, steps)[:-1]):
            at_nodes[n + 1] = transition @ at_nodes[n] + gain
        before = np.minimum((times * density).astype(np.intp), len(nodes) - 1)
        rest = times - nodes[before]
        states = self.transition(rest) @ at_nodes[before] + self.driven(nodes[before], rest)
        pull = self.inputs(times) - states[:, 0]
        accelerations = self.alpha * self.beta * pull - self.alpha * states[:, 1]
        return np.concatenate([states, accelerations[:, None]], axis=1)

    def combined(self, responses: FloatArray) -> FloatArray:
        """Return the responses to ``goal - start`` and to the weights, computed from the responses to the inputs.

        Args:
            responses: responses to the inputs 1, s and ``s psi_i / sum psi``, shape ``(..., 2 + k)``.

        Returns:
            Response to ``goal - start``, followed by the responses to the k weights, shape ``(..., 1 + k)``.
        """
        pull = responses[..., :1] - self.soft_start * responses[..., 1:2]
        return np.concatenate([pull, responses[..., 2:]], axis=-1)


@lru_cache(maxsize=16)
def settling_responses(system: TransformationSystem, n_steps: int, n_settle: int) -> FloatArray:
    """Return the responses on a uniform time grid that includes the settling time after the movement.

    During the settling time, a minimum-jerk profile fades out the responses to s and to the weights. So the movement
    ends at the goal for all weights. The response to the goal is not faded out. With default constants, this response
    differs from its limit by ``(1 + 12.5 p) exp(-12.5 p)`` at time p, e.g. by 5.0e-5 at p = 1 and 1.6e-5 at p = 1.1.

    Args:
        system: spring and its inputs.
        n_steps: number of steps in normalised time from 0 to 1.
        n_settle: number of further steps of the same size after 1.

    Returns:
        Responses to ``goal - start`` and to the weights, with their first and second derivatives, shape
        ``(n_steps + n_settle + 1, 3, 1 + k)``. The array is read-only, because it is cached.
    """
    times = np.arange(n_steps + n_settle + 1) / n_steps
    responses = system.responses_to_inputs(times)
    if n_settle:
        past, width = (times - 1.0) * n_steps / n_settle, n_settle / n_steps
        keep = 1.0 - minimum_jerk(past)[:, None]
        keep_rate = -minimum_jerk_rate(past)[:, None] / width
        keep_second = -minimum_jerk_acceleration(past)[:, None] / width**2
        value, rate, second = (responses[:, i, 1:].copy() for i in range(3))
        responses[:, 0, 1:] = keep * value
        responses[:, 1, 1:] = keep * rate + keep_rate * value
        responses[:, 2, 1:] = keep * second + 2.0 * keep_rate * rate + keep_second * value
    combined = system.combined(responses)
    combined.flags.writeable = False
    return combined
