"""Tests of the spring with closed forms of its responses, for all three cases of damping."""

import numpy as np
import pytest

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.transformation_system import TransformationSystem, settling_responses

TIMES = np.linspace(0.0, 1.1, 221)


def spring(n_weights: int = 20, alpha: float = 25.0, beta: float = 6.25) -> TransformationSystem:
    return TransformationSystem(n_weights, alpha, beta, alpha_phase=10.0, soft_start=False)


def step_response(alpha: float, beta: float) -> FloatArray:
    """Return the step response of a damped oscillator with two (complex) poles, as in textbooks."""
    root = np.sqrt(complex(alpha**2 / 4.0 - alpha * beta))
    one, other = -alpha / 2.0 + root, -alpha / 2.0 - root
    free = (one * np.exp(other * TIMES) - other * np.exp(one * TIMES)) / (one - other)
    return np.asarray(1.0 - free.real)


def test_critical_step_response() -> None:
    response = spring().responses_to_inputs(TIMES)[:, :, 0]
    decay = np.exp(-12.5 * TIMES)
    np.testing.assert_allclose(response[:, 0], 1.0 - (1.0 + 12.5 * TIMES) * decay, atol=1e-13)
    np.testing.assert_allclose(response[:, 1], 156.25 * TIMES * decay, atol=1e-12)
    np.testing.assert_allclose(response[:, 2], 156.25 * (1.0 - 12.5 * TIMES) * decay, atol=1e-10)


@pytest.mark.parametrize("beta", [1.0, 6.0, 7.0, 40.0])
def test_step_response_with_other_damping(beta: float) -> None:
    response = spring(beta=beta).responses_to_inputs(TIMES)[:, 0, 0]
    np.testing.assert_allclose(response, step_response(25.0, beta), atol=1e-12)


def test_response_to_the_phase() -> None:
    # (D + c)^2 y = c^2 exp(-a t) from rest, with c = 12.5 and a = 10.
    gap = 2.5
    expected = 156.25 / gap**2 * (np.exp(-10.0 * TIMES) - np.exp(-12.5 * TIMES) * (1.0 + gap * TIMES))
    np.testing.assert_allclose(spring().responses_to_inputs(TIMES)[:, 0, 1], expected, atol=1e-12)


def test_basis_responses_add_up_to_that_of_the_phase() -> None:
    # The normalised basis functions sum to 1.
    responses = spring().responses_to_inputs(TIMES)
    np.testing.assert_allclose(responses[..., 2:].sum(axis=-1), responses[..., 1], atol=1e-11)


@pytest.mark.parametrize("n_weights", [1, 2, 20, 60])
def test_responses_solve_the_differential_equation(n_weights: int) -> None:
    # An independent integration by the classical Runge-Kutta method with small steps.
    system = spring(n_weights)
    step = 1.0 / 2000.0
    state = np.zeros((2, 2 + n_weights))

    def derivative(time: float, state: FloatArray) -> FloatArray:
        pull = 156.25 * (system.inputs(np.array(time)) - state[0]) - 25.0 * state[1]
        return np.stack([state[1], pull])

    for n in range(2000):
        k1 = derivative(n * step, state)
        k2 = derivative((n + 0.5) * step, state + 0.5 * step * k1)
        k3 = derivative((n + 0.5) * step, state + 0.5 * step * k2)
        k4 = derivative((n + 1) * step, state + step * k3)
        state = state + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    responses = system.responses_to_inputs(np.array([0.0, 1.0]))
    np.testing.assert_allclose(responses[-1, :2], state, atol=1e-9)


def test_all_grids_agree() -> None:
    fine = spring().responses_to_inputs(np.linspace(0.0, 1.0, 1001))
    for n_steps in (1, 7, 10, 333):
        uneven = np.unique(np.concatenate([[0.0], np.round(np.linspace(0.0, 1.0, n_steps + 1) ** 2, 3)]))
        coarse = spring().responses_to_inputs(uneven)
        np.testing.assert_allclose(coarse, fine[np.round(uneven * 1000).astype(int)], atol=1e-12)


def test_basis_is_ordered_in_time() -> None:
    system = spring(12)
    assert system.centres()[0] == 1.0
    assert np.all(np.diff(system.centres()) < 0.0)
    assert np.all(np.diff(system.widths())[:-1] > 0.0)
    peaks = np.argmax(system.inputs(TIMES)[:, 2:] / system.inputs(TIMES)[:, 1:2], axis=0)
    assert np.all(np.diff(peaks) > 0)


def test_settling_fades_all_but_the_pull() -> None:
    responses = settling_responses(spring(), 100, 10)
    plain = spring().combined(spring().responses_to_inputs(np.arange(111) / 100.0))
    np.testing.assert_array_equal(responses[:101], plain[:101])
    np.testing.assert_array_equal(responses[..., 0], plain[..., 0])
    np.testing.assert_array_equal(responses[-1, :, 1:], 0.0)
    assert not responses.flags.writeable


def test_settling_keeps_derivatives_consistent() -> None:
    responses = settling_responses(spring(5), 16000, 1600)[16000:]
    for order in (0, 1):
        difference = (responses[2:, order] - responses[:-2, order]) * 8000.0
        scale = np.max(np.abs(responses[:, order + 1]), axis=0)
        np.testing.assert_allclose(difference / scale, responses[1:-1, order + 1] / scale, atol=1e-4)
