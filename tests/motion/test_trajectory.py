"""Tests of trajectories: interpolation, the constant value after the end, and batches."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.motion.trajectory import Trajectory

RNG = np.random.default_rng(11)
PRIMITIVE = DMP(RNG.normal(scale=0.3, size=(8, 3)))
START, GOAL = RNG.normal(size=(6, 3)), RNG.normal(size=(6, 3))
DURATION = RNG.uniform(0.5, 2.0, 6)
BATCH = PRIMITIVE.trajectory(START, GOAL, DURATION)
SINGLE = [PRIMITIVE.trajectory(START[i], GOAL[i], DURATION[i]) for i in range(6)]


def line() -> Trajectory:
    """Return a trajectory from 1 m to 3 m in 4 s, with three samples and invented derivatives."""
    samples = np.array([[[1.0], [0.0], [8.0]], [[2.0], [4.0], [0.0]], [[3.0], [0.0], [-8.0]]])
    return Trajectory(np.array(4.0), np.array([3.0]), 0.5, samples)


def test_interpolates_and_scales_derivatives_by_the_duration() -> None:
    position, velocity, acceleration = line().at(1.0)
    assert (position.item(), velocity.item(), acceleration.item()) == (1.5, 0.5, 0.25)
    assert line().end == 4.0


def test_begins_at_the_start_and_holds_the_goal() -> None:
    assert [value.item() for value in line().at(-1.0)] == [1.0, 0.0, 0.5]
    for elapsed in (4.0, 4.1, 1e9):
        assert [value.item() for value in line().at(elapsed)] == [3.0, 0.0, 0.0]


def test_returns_the_samples_at_their_times() -> None:
    movement = SINGLE[0]
    times = np.arange(len(movement.samples) - 1) * movement.spacing * movement.duration
    position, velocity, acceleration = movement.at(times)
    np.testing.assert_allclose(position, movement.samples[:-1, 0], atol=1e-12)
    np.testing.assert_allclose(velocity * movement.duration, movement.samples[:-1, 1], atol=1e-10)
    np.testing.assert_allclose(acceleration * movement.duration**2, movement.samples[:-1, 2], atol=1e-9)


@given(st.floats(-1.0, 4.0))
def test_batch_equals_single_reads(elapsed: float) -> None:
    together = BATCH.at(elapsed)
    for i in range(6):
        for batched, single in zip(together, SINGLE[i].at(elapsed), strict=True):
            np.testing.assert_allclose(batched[i], single, rtol=0.0, atol=1e-12)


def test_each_member_has_its_own_time() -> None:
    elapsed = RNG.uniform(0.0, 3.0, (4, 6))
    together = BATCH.at(elapsed)
    assert [quantity.shape for quantity in together] == [(4, 6, 3)] * 3
    for row in range(4):
        for i in range(6):
            for batched, single in zip(together, SINGLE[i].at(elapsed[row, i]), strict=True):
                np.testing.assert_allclose(batched[row, i], single, rtol=0.0, atol=1e-12)


def test_one_movement_is_read_at_many_times_and_with_many_durations() -> None:
    elapsed = RNG.uniform(0.0, 3.0, (4, 6))
    assert SINGLE[0].at(elapsed)[0].shape == (4, 6, 3)
    movement = PRIMITIVE.trajectory(START[0], GOAL[0], DURATION)
    position, velocity, _ = movement.at(0.4)
    assert position.shape == velocity.shape == (6, 3)
    for i in range(6):
        single = PRIMITIVE.trajectory(START[0], GOAL[0], DURATION[i])
        np.testing.assert_array_equal(position[i], single.at(0.4)[0])


def test_velocity_and_acceleration_are_the_derivatives() -> None:
    movement = PRIMITIVE.trajectory(START, GOAL, DURATION, n_steps=4000)
    step = 1e-3
    for elapsed in np.linspace(0.01, 1.5, 40):
        before, now, after = movement.at(elapsed - step), movement.at(elapsed), movement.at(elapsed + step)
        # The end is excluded, because the reference is set to the goal there.
        running = np.abs(elapsed - movement.end) > 2.0 * step
        for order in (0, 1):
            difference = (after[order] - before[order]) / (2.0 * step)
            scale = np.max(np.abs(movement.samples[..., order + 1, :])) / DURATION.min() ** (order + 1)
            error = (difference - now[order + 1])[running] / scale
            np.testing.assert_allclose(error, 0.0, atol=2e-3)


def test_setting_on_the_goal_is_a_step_of_micrometres() -> None:
    reach = DMP(np.zeros((5, 1))).trajectory([0.0], [0.5], 1.0)
    just_before = reach.at(np.nextafter(reach.end, 0.0))
    assert abs(just_before[0].item() - 0.5) < 1e-5
    assert abs(just_before[1].item()) < 2e-3
