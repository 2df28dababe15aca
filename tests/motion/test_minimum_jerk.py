"""The minimum-jerk profile: closed form, symmetry, derivatives."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hybrid_tamp.motion.minimum_jerk import minimum_jerk, minimum_jerk_acceleration, minimum_jerk_rate

PHASES = np.linspace(0.0, 1.0, 1001)


def test_equals_the_polynomial() -> None:
    expected = 10.0 * PHASES**3 - 15.0 * PHASES**4 + 6.0 * PHASES**5
    np.testing.assert_allclose(minimum_jerk(PHASES), expected, atol=1e-14)


def test_goes_from_rest_to_rest() -> None:
    for profile, ends in (
        (minimum_jerk, [0.0, 1.0]),
        (minimum_jerk_rate, [0, 0]),
        (minimum_jerk_acceleration, [0, 0]),
    ):
        assert profile([0.0, 1.0]).tolist() == ends
        assert profile([-3.0, 3.0]).tolist() == ends


def test_peak_rate_is_15_eighths_half_way() -> None:
    assert minimum_jerk_rate(0.5) == 1.875
    assert np.max(minimum_jerk_rate(PHASES)) == 1.875


@given(st.floats(-1.0, 2.0))
def test_is_symmetric_about_half_way(phase: float) -> None:
    assert minimum_jerk(phase) + minimum_jerk(1.0 - phase) == pytest.approx(1.0, abs=1e-14)


@given(st.floats(-1.0, 2.0), st.floats(-1.0, 2.0))
def test_never_goes_back(one: float, other: float) -> None:
    before, after = sorted((one, other))
    assert minimum_jerk(before) <= minimum_jerk(after) + 1e-15


def test_rates_are_the_derivatives() -> None:
    step = 1e-5
    inside = PHASES[1:-1]
    for profile, rate in ((minimum_jerk, minimum_jerk_rate), (minimum_jerk_rate, minimum_jerk_acceleration)):
        difference = (profile(inside + step) - profile(inside - step)) / (2.0 * step)
        np.testing.assert_allclose(difference, rate(inside), atol=1e-8)


def test_keeps_the_batch_shape() -> None:
    for profile in (minimum_jerk, minimum_jerk_rate, minimum_jerk_acceleration):
        assert profile(0.3).shape == ()
        assert profile(np.full((4, 2), 0.3)).shape == (4, 2)
        assert profile(np.full((4, 2), 0.3))[3, 1] == profile(0.3)
