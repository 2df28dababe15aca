"""Unit quaternions: group axioms, closed forms, batches."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import (
    integrate,
    normalized,
    quaternion_conjugate,
    quaternion_from_axis_angle,
    quaternion_from_rotation_vector,
    quaternion_from_rpy,
    quaternion_multiply,
    rotate,
    rotation_vector,
)
from hybrid_tamp.motion.turned_angle import angle_about

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
components = st.floats(-1.0, 1.0, allow_subnormal=False)


def vectors(size: int, limit: float = 1.0) -> st.SearchStrategy[FloatArray]:
    return st.lists(st.floats(-limit, limit), min_size=size, max_size=size).map(np.array)


def directions(size: int) -> st.SearchStrategy[FloatArray]:
    return vectors(size).filter(lambda vector: float(np.linalg.norm(vector)) > 0.1).map(normalized)


quaternions = directions(4)
points = vectors(3, 10.0)


def matrix(axis: int, angle: float) -> FloatArray:
    """Return the rotation matrix about a coordinate axis, as in textbooks."""
    turned = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turned[[i, j], [i, j]] = np.cos(angle)
    turned[i, j], turned[j, i] = -np.sin(angle), np.sin(angle)
    return turned


def same_rotation(a: FloatArray, b: FloatArray, tolerance: float = 1e-12) -> bool:
    return bool(np.all(1.0 - np.abs(np.sum(a * b, axis=-1)) < tolerance))


@given(quaternions, quaternions, quaternions)
def test_product_is_associative(a: FloatArray, b: FloatArray, c: FloatArray) -> None:
    left = quaternion_multiply(quaternion_multiply(a, b), c)
    np.testing.assert_allclose(left, quaternion_multiply(a, quaternion_multiply(b, c)), atol=1e-14)


@given(quaternions)
def test_identity_and_inverse(q: FloatArray) -> None:
    np.testing.assert_array_equal(quaternion_multiply(q, IDENTITY), q)
    np.testing.assert_array_equal(quaternion_multiply(IDENTITY, q), q)
    np.testing.assert_allclose(quaternion_multiply(q, quaternion_conjugate(q)), IDENTITY, atol=1e-15)
    np.testing.assert_allclose(quaternion_multiply(quaternion_conjugate(q), q), IDENTITY, atol=1e-15)


@given(quaternions, quaternions)
def test_product_of_units_is_a_unit_and_its_conjugate_reverses(a: FloatArray, b: FloatArray) -> None:
    product = quaternion_multiply(a, b)
    assert np.linalg.norm(product) == pytest.approx(1.0, abs=1e-14)
    reversed_product = quaternion_multiply(quaternion_conjugate(b), quaternion_conjugate(a))
    np.testing.assert_allclose(quaternion_conjugate(product), reversed_product, atol=1e-15)


@given(quaternions, quaternions, points)
def test_rotating_by_a_product_is_rotating_twice(a: FloatArray, b: FloatArray, v: FloatArray) -> None:
    np.testing.assert_allclose(rotate(quaternion_multiply(a, b), v), rotate(a, rotate(b, v)), atol=1e-13)


@given(quaternions, points, points)
def test_rotation_keeps_lengths_angles_and_handedness(q: FloatArray, v: FloatArray, w: FloatArray) -> None:
    assert np.dot(rotate(q, v), rotate(q, w)) == pytest.approx(np.dot(v, w), abs=1e-11)
    np.testing.assert_allclose(np.cross(rotate(q, v), rotate(q, w)), rotate(q, np.cross(v, w)), atol=1e-11)


@given(quaternions, points)
def test_opposite_quaternions_are_one_rotation(q: FloatArray, v: FloatArray) -> None:
    np.testing.assert_allclose(rotate(-q, v), rotate(q, v), atol=1e-14)


@pytest.mark.parametrize("axis", [0, 1, 2])
@given(angle=st.floats(-7.0, 7.0), v=points)
def test_axis_angle_is_the_textbooks_matrix(axis: int, angle: float, v: FloatArray) -> None:
    quaternion = quaternion_from_axis_angle(2.5 * np.eye(3)[axis], angle)
    np.testing.assert_allclose(rotate(quaternion, v), matrix(axis, angle) @ v, atol=1e-13)


@given(vectors(3, 7.0), points)
def test_rpy_is_yaw_after_pitch_after_roll(rpy: FloatArray, v: FloatArray) -> None:
    expected = matrix(2, rpy[2]) @ matrix(1, rpy[1]) @ matrix(0, rpy[0]) @ v
    np.testing.assert_allclose(rotate(quaternion_from_rpy(rpy), v), expected, atol=1e-13)


@pytest.mark.filterwarnings("ignore")
def test_rpy_is_pybullets() -> None:
    pybullet = pytest.importorskip("pybullet")
    for rpy in np.random.default_rng(0).uniform(-3.0, 3.0, (50, 3)):
        expected = np.array(pybullet.getQuaternionFromEuler(rpy.tolist()))
        assert same_rotation(quaternion_from_rpy(rpy), expected)


@given(directions(3), st.floats(0.0, 3.1))
def test_rotation_vector_is_axis_times_angle(axis: FloatArray, angle: float) -> None:
    quaternion = quaternion_from_axis_angle(axis, angle)
    np.testing.assert_allclose(rotation_vector(quaternion), angle * axis, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(rotation_vector(-quaternion), angle * axis, rtol=1e-12, atol=1e-13)


@given(quaternions)
def test_exponential_undoes_logarithm_the_shortest_way(q: FloatArray) -> None:
    vector = rotation_vector(q)
    assert np.linalg.norm(vector) <= np.pi + 1e-12
    assert same_rotation(quaternion_from_rotation_vector(vector), q)


@pytest.mark.parametrize("size", [0.0, 1e-300, 1e-160, 1e-20, 1e-9, 3e-9, 1e-6, 1e-3])
def test_logarithm_keeps_small_angles(size: float) -> None:
    vector = size * np.array([0.6, 0.0, -0.8])
    np.testing.assert_allclose(rotation_vector(quaternion_from_rotation_vector(vector)), vector, rtol=1e-12)


def test_logarithm_of_half_a_turn() -> None:
    np.testing.assert_allclose(rotation_vector([0.0, 1.0, 0.0, 0.0]), [0.0, np.pi, 0.0])


@given(quaternions, vectors(3, 5.0), st.floats(0.0, 1.0))
def test_integration_turns_in_the_world(q: FloatArray, omega: FloatArray, dt: float) -> None:
    later = integrate(q, omega, dt)
    angle = float(np.linalg.norm(omega)) * dt
    expected = quaternion_multiply(quaternion_from_rotation_vector(omega * dt), q)
    np.testing.assert_allclose(later, expected, atol=1e-14)
    if angle > 1e-6:
        # The axis of rotation itself is at rest in the world.
        np.testing.assert_allclose(rotate(later, rotate(quaternion_conjugate(q), omega)), omega, atol=1e-13)


@given(quaternions, vectors(3, 5.0))
def test_integration_is_exact_for_constant_velocity(q: FloatArray, omega: FloatArray) -> None:
    in_steps = q
    for _ in range(10):
        in_steps = integrate(in_steps, omega, 0.1)
    np.testing.assert_allclose(in_steps, integrate(q, omega, 1.0), atol=1e-13)


def test_normalized_at_the_ends_of_the_number_range() -> None:
    extremes = normalized([[3e200, 4e200], [3e-200, -4e-200], [-3e-310, 0.0]])
    np.testing.assert_allclose(extremes, [[0.6, 0.8], [0.6, -0.8], [-1.0, 0.0]])


@pytest.mark.parametrize("bad", [[0.0, 0.0, 0.0], [np.nan, 1.0, 0.0], [np.inf, 0.0, 0.0]])
def test_normalized_refuses_what_has_no_direction(bad: list[float]) -> None:
    with pytest.raises(ValueError, match="zero or not finite"):
        normalized([[1.0, 0.0, 0.0], bad])


def test_wrong_sizes_are_refused() -> None:
    with pytest.raises(ValueError, match=r"a must have shape \(\.\.\., 4\), got \(3,\)"):
        quaternion_multiply([0.0, 0.0, 1.0], IDENTITY)
    with pytest.raises(ValueError, match=r"vectors must have shape \(\.\.\., 3\), got \(4,\)"):
        rotate(IDENTITY, IDENTITY)
    with pytest.raises(ValueError, match=r"\(t, \.\.\., 4\)"):
        angle_about([0.0, 0.0, 1.0], IDENTITY)


def test_batches_broadcast_and_equal_single_calls() -> None:
    rng = np.random.default_rng(3)
    a, b = normalized(rng.normal(size=(5, 1, 4))), normalized(rng.normal(size=(7, 4)))
    v, omega = rng.normal(size=(7, 3)), rng.normal(size=(5, 1, 3))
    results = quaternion_multiply(a, b), rotate(a, v), integrate(a, omega, np.full(7, 0.1))
    assert [result.shape for result in results] == [(5, 7, 4), (5, 7, 3), (5, 7, 4)]
    for i in range(5):
        for j in range(7):
            np.testing.assert_allclose(results[0][i, j], quaternion_multiply(a[i, 0], b[j]), rtol=0, atol=1e-15)
            np.testing.assert_allclose(results[1][i, j], rotate(a[i, 0], v[j]), rtol=0, atol=1e-15)
            np.testing.assert_allclose(results[2][i, j], integrate(a[i, 0], omega[i, 0], 0.1), atol=1e-15)
    assert quaternion_from_axis_angle([0.0, 0.0, 1.0], np.zeros((2, 6))).shape == (2, 6, 4)
    assert quaternion_from_rpy(np.zeros((2, 6, 3))).shape == (2, 6, 4)
    assert rotation_vector(a).shape == (5, 1, 3)


@given(quaternions, directions(3), st.floats(-40.0, 40.0))
def test_angle_about_counts_whole_turns(q: FloatArray, axis: FloatArray, total: float) -> None:
    angles = np.linspace(0.0, total, 60)
    series = quaternion_multiply(q, quaternion_from_axis_angle(axis, angles))
    # The sign of a quaternion in a recording is arbitrary.
    series[::3] *= -1.0
    np.testing.assert_allclose(angle_about(3.0 * axis, series), angles, atol=1e-11)


def test_angle_about_an_axis_at_right_angles_is_0() -> None:
    series = quaternion_from_axis_angle([1.0, 0.0, 0.0], np.linspace(0.0, 20.0, 100))
    np.testing.assert_allclose(angle_about([0.0, 1.0, 0.0], series), 0.0, atol=1e-12)


def test_angle_about_follows_a_body_that_also_turns_otherwise() -> None:
    # A cylinder rolls by 9 rad about its axis, while it turns by 2 rad about the vertical along a curve.
    share = np.linspace(0.0, 1.0, 400)
    heading = quaternion_from_axis_angle([0.0, 0.0, 1.0], 2.0 * share)
    rolling = quaternion_from_axis_angle([0.0, 1.0, 0.0], 9.0 * share)
    angles = angle_about([0.0, 1.0, 0.0], quaternion_multiply(heading, rolling))
    np.testing.assert_allclose(angles, 9.0 * share, atol=2e-4)


def test_angle_about_in_batches() -> None:
    rng = np.random.default_rng(1)
    initial, times = normalized(rng.normal(size=(6, 4))), np.linspace(0.0, 5.0, 50)
    series = integrate(initial, [0.3, 0.2, -4.0], times[:, None])
    axes = normalized(rng.normal(size=(6, 3)))
    together = angle_about(axes, series)
    assert together.shape == (50, 6)
    for i in range(6):
        np.testing.assert_allclose(together[:, i], angle_about(axes[i], series[:, i]), atol=1e-13)
    many_axes = angle_about(axes, series[:, 0])
    np.testing.assert_allclose(many_axes[:, 4], angle_about(axes[4], series[:, 0]), atol=1e-13)
    assert angle_about(axes[0], series[:1]).tolist() == [[0.0] * 6]
