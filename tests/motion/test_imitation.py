"""Tests of learning from demonstrations: recovery, noise, few samples and refusals."""

import numpy as np
import pytest

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.motion.minimum_jerk import minimum_jerk


def reach(phase: FloatArray) -> FloatArray:
    """Return the path [m] of a hand that rises, moves across and descends beside an object."""
    height = 0.3 + 0.2 * minimum_jerk(phase / 0.45) - 0.25 * minimum_jerk((phase - 0.5) / 0.5)
    return np.stack([0.5 * minimum_jerk((phase - 0.1) / 0.8), -0.2 * minimum_jerk(phase), height], axis=-1)


TIME = np.linspace(0.0, 1.2, 241)
POSITIONS = reach(TIME / 1.2)


def replay(primitive: DMP) -> FloatArray:
    return primitive.rollout(POSITIONS[0], POSITIONS[-1], 1.2, 0.005)[1][:241]


def rms(error: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.sum(error**2, axis=-1))))


@pytest.mark.parametrize("soft_start", [False, True])
def test_curved_reach_within_a_millimetre(soft_start: bool) -> None:
    replayed = replay(DMP.imitate(TIME, POSITIONS, 20, soft_start=soft_start))
    assert rms(replayed - POSITIONS) < 0.2e-3
    assert np.linalg.norm(replayed[-1] - POSITIONS[-1]) < 0.01e-3


def test_velocities_are_imitated_too() -> None:
    _, _, velocities = DMP.imitate(TIME, POSITIONS).rollout(POSITIONS[0], POSITIONS[-1], 1.2, 0.005)
    demonstrated = np.gradient(POSITIONS, TIME, axis=0)
    assert rms(velocities[:241] - demonstrated) < 0.01 * np.max(np.abs(demonstrated))


@pytest.mark.parametrize("soft_start", [False, True])
def test_a_movement_of_a_primitive_is_recovered(soft_start: bool) -> None:
    source = DMP(np.random.default_rng(5).normal(scale=0.3, size=(10, 2)), soft_start=soft_start)
    # The movement has no settling time, and lasts until the phase has almost decayed.
    time, positions, _ = source.rollout([0.0, 1.0], [0.4, 1.0], 1.0, 0.002, settle=0.0)
    learnt = DMP.imitate(time, positions, 10, soft_start=soft_start)
    _, replayed, _ = learnt.rollout(positions[0], positions[-1], 1.0, 0.002, settle=0.0)
    assert rms(replayed - positions) < 1e-3


def test_shift_and_unit_of_time_do_not_matter() -> None:
    reference = DMP.imitate(TIME, POSITIONS)
    moved = DMP.imitate(7.0 * TIME - 3.0, POSITIONS + np.array([5.0, -2.0, 1.0]))
    # The weights of late basis functions, which act through a small s, are large.
    scale = reference.system.centres()[:, None]
    np.testing.assert_allclose(moved.weights * scale, reference.weights * scale, atol=1e-8)


def test_uneven_sampling() -> None:
    time = 1.2 * np.linspace(0.0, 1.0, 241) ** 1.5
    assert rms(replay(DMP.imitate(time, reach(time / 1.2))) - POSITIONS) < 0.5e-3


def test_noise_is_smoothed() -> None:
    noise = np.random.default_rng(2).normal(scale=2e-3, size=POSITIONS.shape)
    noise[[0, -1]] = 0.0
    assert rms(replay(DMP.imitate(TIME, POSITIONS + noise)) - POSITIONS) < 0.5 * rms(noise)


@pytest.mark.parametrize(("n_samples", "tolerance"), [(12, 2e-3), (20, 1e-3)])
def test_fewer_samples_than_weights_are_joined_smoothly(n_samples: int, tolerance: float) -> None:
    phase = np.linspace(0.0, 1.0, n_samples)
    assert np.max(np.abs(replay(DMP.imitate(1.2 * phase, reach(phase))) - POSITIONS)) < tolerance


def test_several_demonstrations_are_averaged() -> None:
    bump = 0.01 * np.sin(np.pi * TIME / 1.2)[:, None] ** 3
    both = DMP.imitate([TIME, TIME], [POSITIONS + bump, POSITIONS - bump])
    assert rms(replay(both) - POSITIONS) < 0.2e-3


def test_demonstrations_may_differ_in_length_start_goal_and_duration() -> None:
    slow = np.linspace(2.0, 4.0, 101)
    both = DMP.imitate([TIME, slow], [POSITIONS, reach((slow - 2.0) / 2.0) + np.array([0.3, 0.0, 0.1])])
    assert rms(replay(both) - POSITIONS) < 0.2e-3


def test_standing_still_is_learnt_as_zero_weights() -> None:
    primitive = DMP.imitate(TIME, np.full((241, 2), 0.7))
    np.testing.assert_allclose(primitive.weights, 0.0, atol=1e-9)


@pytest.mark.parametrize("n_weights", [1, 2, 3, 4, 10, 50])
def test_any_number_of_weights_arrives(n_weights: int) -> None:
    primitive = DMP.imitate(TIME, POSITIONS, n_weights)
    _, positions, velocities = primitive.rollout(POSITIONS[0], POSITIONS[-1], 1.2, 0.005)
    assert primitive.weights.shape == (n_weights, 3)
    assert np.linalg.norm(positions[-1] - POSITIONS[-1]) < 0.01e-3
    assert np.linalg.norm(velocities[-1]) < 1e-3
    # With fewer weights, the primitive cannot be both at the goal and at rest before settling.
    if n_weights >= 4:
        assert np.linalg.norm(positions[240] - POSITIONS[-1]) < 1e-3


def with_value(array: FloatArray, index: int, value: float) -> FloatArray:
    changed: FloatArray = array.copy()
    changed[index] = value
    return changed


@pytest.mark.parametrize(
    ("time", "positions", "message"),
    [
        (TIME[:4], POSITIONS[:4], "at least 5 samples, got 4"),
        (TIME[:0], POSITIONS[:0], "at least 5 samples, got 0"),
        (with_value(TIME, 7, TIME[6]), POSITIONS, "must strictly increase, but sample 7 is at"),
        (TIME[::-1], POSITIONS, "must strictly increase, but sample 1 is at"),
        (with_value(TIME, 7, np.nan), POSITIONS, "must be finite"),
        (TIME, with_value(POSITIONS, 7, np.inf), "must be finite"),
        (TIME[:-1], POSITIONS, r"got \(240,\) and \(241, 3\)"),
        (TIME, POSITIONS[:, 0], r"got \(241,\) and \(241,\)"),
        (TIME, POSITIONS[:, :0], r"got \(241,\) and \(241, 0\)"),
        ([TIME, TIME], [POSITIONS], "equal numbers of arrays, got 2 and 1"),
        ([TIME, TIME], [POSITIONS, POSITIONS[:, :2]], r"number of dimensions, got \[2, 3\]"),
        ([TIME, TIME[:4]], [POSITIONS, POSITIONS[:4]], "demonstration 2: must have at least 5"),
    ],
)
def test_bad_demonstrations_are_refused(time: FloatArray, positions: FloatArray, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        DMP.imitate(time, positions)


def test_no_weights_are_refused() -> None:
    with pytest.raises(ValueError, match="n_weights must be at least 1, got 0"):
        DMP.imitate(TIME, POSITIONS, 0)
