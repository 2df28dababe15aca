"""Dynamic movement primitives: closed form, goals, scaling in time, invariances, batches, speed."""

import subprocess
import sys
import time as clock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.motion.minimum_jerk import minimum_jerk
from hybrid_tamp.motion.trajectory import Trajectory

PHASE = np.linspace(0.0, 1.0, 241)
REACH = np.stack(
    [
        0.5 * minimum_jerk((PHASE - 0.1) / 0.8),
        -0.2 * minimum_jerk(PHASE),
        0.3 + 0.2 * minimum_jerk(PHASE / 0.45) - 0.25 * minimum_jerk((PHASE - 0.5) / 0.5),
    ],
    axis=-1,
)
START, GOAL = REACH[0], REACH[-1]
LEARNT = DMP.imitate(1.2 * PHASE, REACH)
HARD = DMP.imitate(1.2 * PHASE, REACH, soft_start=False)
PLAIN = DMP(np.zeros((20, 1)))
shifts = st.lists(st.floats(-0.3, 0.3), min_size=3, max_size=3).map(np.array)


@pytest.mark.parametrize(("duration", "dt"), [(1.0, 0.01), (1.0, 0.1), (2.5, 1.0 / 240.0), (0.3, 0.7)])
def test_zero_weights_are_the_critically_damped_spring(duration: float, dt: float) -> None:
    time, positions, velocities = PLAIN.rollout([0.0], [1.0], duration, dt)
    p = time / duration
    decay = np.exp(-12.5 * p)
    np.testing.assert_allclose(positions[:, 0], 1.0 - (1.0 + 12.5 * p) * decay, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(velocities[:, 0] * duration, 156.25 * p * decay, rtol=0.0, atol=1e-11)


def test_plain_reach_arrives() -> None:
    time, positions, velocities = PLAIN.rollout([0.0], [0.5], 1.0, 0.01)
    at_end = int(np.argmin(np.abs(time - 1.0)))
    assert abs(positions[at_end, 0] - 0.5) < 0.03e-3
    assert abs(positions[-1, 0] - 0.5) < 0.01e-3
    assert abs(velocities[at_end, 0]) < 5e-3
    assert abs(velocities[-1, 0]) < 2e-3


@pytest.mark.parametrize("primitive", [LEARNT, HARD])
def test_learnt_reach_arrives_at_its_own_goal(primitive: DMP) -> None:
    time, positions, velocities = primitive.rollout(START, GOAL, 1.2, 0.005)
    assert time[240] == pytest.approx(1.2)
    assert np.linalg.norm(positions[240] - GOAL) < 0.01e-3
    assert np.linalg.norm(velocities[240]) < 1e-3
    assert np.linalg.norm(positions[-1] - GOAL) < 0.01e-3
    assert np.linalg.norm(velocities[-1]) < 1e-3


@pytest.mark.parametrize("primitive", [LEARNT, HARD])
@given(start_shift=shifts, goal_shift=shifts)
def test_new_goal_is_reached(primitive: DMP, start_shift: FloatArray, goal_shift: FloatArray) -> None:
    start, goal = START + start_shift, GOAL + goal_shift
    _, positions, velocities = primitive.rollout(start, goal, 0.8, 0.8 / 240)
    np.testing.assert_array_equal(positions[0], start)
    np.testing.assert_array_equal(velocities[0], 0.0)
    assert np.linalg.norm(positions[240] - goal) < 1e-3
    assert np.linalg.norm(positions[-1] - goal) < 0.05e-3
    assert np.linalg.norm(velocities[-1]) < 5e-3


@given(st.integers(0, 1000))
def test_any_weights_settle_on_the_goal(seed: int) -> None:
    weights = np.random.default_rng(seed).normal(scale=30.0, size=(20, 3))
    _, positions, velocities = DMP(weights).rollout(START, GOAL, 1.0, 0.005)
    np.testing.assert_allclose(positions[-1], GOAL, atol=0.02e-3)
    np.testing.assert_allclose(velocities[-1], 0.0, atol=2e-3)


def test_start_equal_to_goal_still_moves() -> None:
    # The hand is lifted and put down again, because the forcing term is not scaled by goal - start.
    up_and_down = np.stack([0.0 * PHASE, 0.1 * np.sin(np.pi * PHASE) ** 4], axis=-1)
    _, positions, _ = DMP.imitate(PHASE, up_and_down).rollout([0.2, 0.2], [0.2, 0.2], 1.0, 1.0 / 240)
    np.testing.assert_allclose(positions[:241] - 0.2, up_and_down, atol=1e-3)


def test_soft_start_begins_without_a_jump_of_acceleration() -> None:
    there = START + np.array([0.3, 0.0, 0.0])
    goal = GOAL + np.array([0.0, 0.3, 0.0])
    soft, hard = (each.trajectory(there, goal, 1.0).at(0.0)[2] for each in (LEARNT, HARD))
    own = LEARNT.trajectory(START, GOAL, 1.0).at(0.0)[2]
    np.testing.assert_allclose(soft, own, atol=1e-9)
    np.testing.assert_allclose(hard - HARD.trajectory(START, GOAL, 1.0).at(0.0)[2], [-46.875, 46.875, 0.0])


@pytest.mark.parametrize("duration", [0.3, 1.0, 4.0])
def test_scaling_in_time_is_exact(duration: float) -> None:
    time, positions, velocities = LEARNT.rollout(START, GOAL, duration, duration / 100)
    slow = 2.0 * duration
    slow_time, slow_positions, slow_velocities = LEARNT.rollout(START, GOAL, slow, slow / 100)
    np.testing.assert_array_equal(slow_time, 2.0 * time)
    np.testing.assert_array_equal(slow_positions, positions)
    np.testing.assert_array_equal(slow_velocities, 0.5 * velocities)


def test_scaling_in_time_with_the_same_step() -> None:
    _, positions, _ = LEARNT.rollout(START, GOAL, 1.0, 0.01)
    _, slow_positions, _ = LEARNT.rollout(START, GOAL, 2.0, 0.01)
    np.testing.assert_allclose(slow_positions[::2], positions, rtol=0.0, atol=1e-10)


@given(shifts)
def test_shifting_start_and_goal_shifts_the_movement(shift: FloatArray) -> None:
    _, positions, _ = LEARNT.rollout(START, GOAL, 1.0, 0.02)
    _, shifted, _ = LEARNT.rollout(START + shift, GOAL + shift, 1.0, 0.02)
    np.testing.assert_allclose(shifted, positions + shift, atol=1e-13)


def test_turning_the_axes_turns_the_movement() -> None:
    turn, _ = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))
    _, positions, _ = LEARNT.rollout(START, GOAL, 1.0, 0.02)
    primitive = DMP(LEARNT.weights @ turn, soft_start=True)
    _, turned, _ = primitive.rollout(START @ turn, GOAL @ turn, 1.0, 0.02)
    np.testing.assert_allclose(turned, positions @ turn, atol=1e-12)


def test_time_grid() -> None:
    time, positions, velocities = PLAIN.rollout([0.0], [1.0], 0.25, 0.1, settle=0.5)
    # The trajectory has three steps, because 0.1 does not divide 0.25. Two more steps are after the end.
    np.testing.assert_allclose(time, np.arange(6) * 0.25 / 3.0)
    assert positions.shape == velocities.shape == (6, 1)
    assert len(PLAIN.rollout([0.0], [1.0], 0.3, 0.1, settle=0.0)[0]) == 4


def test_batch_of_starts_and_goals_equals_single_rollouts() -> None:
    rng = np.random.default_rng(8)
    starts, goals = START + rng.normal(scale=0.1, size=(4, 1, 3)), GOAL + rng.normal(scale=0.1, size=(5, 3))
    time, positions, velocities = LEARNT.rollout(starts, goals, 1.3, 0.01)
    assert positions.shape == velocities.shape == (len(time), 4, 5, 3)
    for i in range(4):
        for j in range(5):
            _, position, velocity = LEARNT.rollout(starts[i, 0], goals[j], 1.3, 0.01)
            np.testing.assert_array_equal(positions[:, i, j], position)
            np.testing.assert_array_equal(velocities[:, i, j], velocity)


def test_batch_of_durations_shares_the_grid() -> None:
    durations = np.array([0.5, 1.0, 2.0])
    time, positions, velocities = LEARNT.rollout(START, GOAL, durations, 0.01)
    assert time.shape == (221, 3)
    assert positions.shape == velocities.shape == (221, 3, 3)
    for i, duration in enumerate(durations):
        single_time, position, velocity = LEARNT.rollout(START, GOAL, duration, duration / 200)
        np.testing.assert_allclose(time[:, i], single_time, rtol=1e-15)
        np.testing.assert_array_equal(positions[:, i], position)
        np.testing.assert_array_equal(velocities[:, i], velocity)


def test_batch_of_weights_equals_single_rollouts() -> None:
    weights = LEARNT.weights + np.random.default_rng(9).normal(size=(6, 20, 3))
    _, positions, velocities = DMP(weights).rollout(START, GOAL, np.linspace(1.0, 2.0, 6), 0.01)
    assert positions.shape == (221, 6, 3)
    for i in range(6):
        _, position, velocity = DMP(weights[i]).rollout(START, GOAL, 1.0 + 0.2 * i, (1.0 + 0.2 * i) / 200)
        np.testing.assert_allclose(positions[:, i], position, rtol=0.0, atol=1e-12)
        np.testing.assert_allclose(velocities[:, i], velocity, rtol=0.0, atol=1e-11)
    assert DMP(weights).rollout(np.zeros((4, 1, 3)), GOAL, 1.0, 0.1)[1].shape == (12, 4, 6, 3)


def test_trajectory_reads_what_the_rollout_writes() -> None:
    time, positions, velocities = LEARNT.rollout(START, GOAL, 1.5, 0.005)
    movement = LEARNT.trajectory(START, GOAL, 1.5, n_steps=300)
    assert isinstance(movement, Trajectory)
    position, velocity, _ = movement.at(time[:-1])
    np.testing.assert_allclose(position, positions[:-1], atol=1e-12)
    np.testing.assert_allclose(velocity, velocities[:-1], atol=1e-11)
    # Between the samples the error is that of linear interpolation.
    fine_time, fine_positions, _ = LEARNT.rollout(START, GOAL, 1.5, 0.0005)
    assert np.max(np.abs(movement.at(fine_time)[0] - fine_positions)) < 0.1e-3


def test_results_do_not_share_memory_with_the_cache() -> None:
    _, positions, velocities = LEARNT.rollout(START, GOAL, 1.0, 0.1)
    expected = positions.copy()
    positions[:] = velocities[:] = np.nan
    np.testing.assert_array_equal(LEARNT.rollout(START, GOAL, 1.0, 0.1)[1], expected)


@pytest.mark.parametrize("name", ["alpha", "beta", "alpha_phase"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.inf, np.nan])
def test_bad_constants_are_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{name} must be positive and finite"):
        DMP(np.zeros((5, 1)), **{name: value})  # type: ignore[arg-type]


@pytest.mark.parametrize(("shape", "value"), [((5,), 0.0), ((0, 3), 0.0), ((5, 0), 0.0), ((5, 3), np.nan)])
def test_bad_weights_are_refused(shape: tuple[int, ...], value: float) -> None:
    with pytest.raises(ValueError, match="weights must be finite and of shape"):
        DMP(np.full(shape, value))


@pytest.mark.parametrize(
    ("duration", "dt", "settle", "message"),
    [
        (0.0, 0.1, 0.1, "duration must be positive"),
        ([1.0, -1.0], 0.1, 0.1, "duration must be positive"),
        (np.nan, 0.1, 0.1, "duration must be positive"),
        (np.inf, 0.1, 0.1, "duration must be positive"),
        (1.0, 0.0, 0.1, "dt must be positive"),
        (1.0, np.nan, 0.1, "dt must be positive"),
        (1.0, 0.1, -0.1, "settle must be at least 0"),
    ],
)
def test_bad_times_are_refused(duration: float, dt: float, settle: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        PLAIN.rollout([0.0], [1.0], duration, dt, settle)


def test_bad_shapes_are_refused() -> None:
    with pytest.raises(ValueError, match=r"must have shape \(\.\.\., 1\), got \(2,\) and \(1,\)"):
        PLAIN.rollout([0.0, 0.0], [1.0], 1.0, 0.1)
    with pytest.raises(ValueError, match="n_steps must be at least 1"):
        PLAIN.trajectory([0.0], [1.0], 1.0, n_steps=0)


def test_rollouts_are_fast() -> None:
    # About 0.4 us a step on a grid seen before and 8 us on a new one; the limits allow for slow machines.
    def seconds(n_steps: int) -> float:
        begin = clock.process_time()
        LEARNT.rollout(START, GOAL, 1.0, 1.0 / n_steps)
        return clock.process_time() - begin

    assert min(seconds(n_steps) / n_steps for n_steps in range(1801, 1809)) < 50e-6
    assert min(seconds(1801) / 1801 for _ in range(8)) < 10e-6


def test_import_is_light() -> None:
    code = "import hybrid_tamp.motion.dmp, hybrid_tamp.motion.poses, sys; print('scipy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
