"""Tests of profiles, i.e. of one-dimensional primitives that describe a movement along a given path."""

import numpy as np
import pytest

from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.motion.minimum_jerk import minimum_jerk, minimum_jerk_rate
from hybrid_tamp.motion.profile import Profile

TIME = np.linspace(0.0, 1.0, 201)
STRAIGHT = Profile(DMP.imitate(TIME, minimum_jerk(TIME)[:, None]))
PHASES = np.linspace(-0.2, 1.5, 681)


def test_a_straight_movement_is_that_of_minimum_jerk() -> None:
    np.testing.assert_allclose(STRAIGHT.share(PHASES), minimum_jerk(PHASES), atol=4e-4)
    np.testing.assert_allclose(STRAIGHT.rate(PHASES), minimum_jerk_rate(PHASES), atol=0.04)


def test_it_reads_what_the_trajectory_says() -> None:
    inside = PHASES[(PHASES >= 0.0) & (STRAIGHT.trajectory.end - STRAIGHT.trajectory.spacing > PHASES)]
    position, velocity, _ = STRAIGHT.trajectory.at(inside)
    np.testing.assert_allclose(STRAIGHT.share(inside), position[:, 0], atol=1e-12)
    np.testing.assert_allclose(STRAIGHT.rate(inside), velocity[:, 0], atol=1e-12)


def test_it_begins_and_ends_at_rest_exactly() -> None:
    for profile in (STRAIGHT, Profile(DMP(np.random.default_rng(3).normal(size=(8, 1)), soft_start=True))):
        for phase, share in ((-0.1, 0.0), (0.0, 0.0), (1.11, 1.0), (5.0, 1.0)):
            assert (float(profile.share(phase)), float(profile.rate(phase))) == (share, 0.0)


def test_a_batch_equals_single_reads() -> None:
    phases = PHASES[:600].reshape(20, 30)
    assert STRAIGHT.share(phases).shape == STRAIGHT.rate(phases).shape == (20, 30)
    assert STRAIGHT.share(phases)[7, 9] == STRAIGHT.share(phases[7, 9])


def test_arrival_is_where_exit_conditions_hold() -> None:
    amount, duration, near, slow = 0.5, 1.4, 0.06, 0.02
    end = float(STRAIGHT.arrival(amount, duration, near, slow))
    for time, holds in ((end - 0.01, False), (end + 0.01, True)):
        left = amount * (1.0 - STRAIGHT.share(time / duration))
        speed = amount * STRAIGHT.rate(time / duration) / duration
        assert bool(left <= near and speed <= slow) == holds
    assert np.allclose(STRAIGHT.arrival(np.array([0.1, 0.5]), duration, near, slow)[1], end)


def test_arrival_of_what_is_never_near_enough_is_the_end() -> None:
    assert STRAIGHT.arrival(1.0, 2.0, -1.0, 1.0) == pytest.approx(2.0 * STRAIGHT.trajectory.end)
    assert STRAIGHT.arrival(1.0, 2.0, 5.0, 5.0) == 0.0


@pytest.mark.parametrize("shape", [(5, 3), (4, 5, 1)])
def test_another_shape_of_weights_is_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=r"must have shape \(k, 1\)"):
        Profile(DMP(np.zeros(shape)))
