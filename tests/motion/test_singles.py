"""One quaternion or vector is computed with plain numbers, with the same results as small batches."""

from collections.abc import Callable

import numpy as np
import pytest

from hybrid_tamp.motion import columns, singles
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import (
    cross,
    integrate,
    normalized,
    quaternion_from_axis_angle,
    quaternion_from_rotation_vector,
    quaternion_multiply,
    rotate,
    rotation_vector,
)

ONES = [(), (1,), (1, 1)]


@pytest.mark.parametrize("left", ONES)
@pytest.mark.parametrize("right", ONES)
def test_one_equals_a_row_of_a_batch(left: tuple[int, ...], right: tuple[int, ...]) -> None:
    rng = np.random.default_rng(5)
    q, r, u, v = (rng.normal(size=(6, size)) for size in (4, 4, 3, 3))
    q, r, u = normalized(q), normalized(r), normalized(u)
    angle = rng.normal(size=6)
    pairs: list[tuple[Callable[..., FloatArray], FloatArray, FloatArray]] = [
        (cross, u, v),
        (rotate, q, v),
        (quaternion_multiply, q, r),
        (lambda a, b: integrate(a, b, 0.1), q, v),
    ]
    for function, one, other in pairs:
        batch = function(one, other)
        for row in range(6):
            found = function(one[row].reshape(*left, -1), other[row].reshape(*right, -1))
            assert found.shape == (*max(left, right, key=len), batch.shape[-1])
            np.testing.assert_allclose(found.ravel(), batch[row], rtol=1e-14, atol=1e-15)
    batch = quaternion_from_axis_angle(u, angle)
    for row in range(6):
        found = quaternion_from_axis_angle(u[row].reshape(*left, 3), angle[row].reshape(right))
        assert found.shape == (*max(left, right, key=len), 4)
        np.testing.assert_allclose(found.ravel(), batch[row], rtol=1e-14, atol=1e-15)


def test_one_vector_is_scaled_and_turned_as_a_row_of_a_batch() -> None:
    vectors = np.random.default_rng(6).normal(size=(6, 3))
    for function in (normalized, quaternion_from_rotation_vector):
        for row, wanted in zip(vectors, function(vectors), strict=True):
            np.testing.assert_allclose(function(row), wanted, rtol=1e-14)


def test_one_quaternion_gives_the_rotation_vector_of_a_row_of_a_batch() -> None:
    quaternions = normalized(np.random.default_rng(8).normal(size=(6, 4)))
    nearly_none = normalized(np.array([[1e-9, -2e-10, 3e-10, -1.0], [0.0, 0.0, 0.0, 1.0]]))
    for each in (quaternions, nearly_none):
        for row, wanted in zip(each, rotation_vector(each), strict=True):
            np.testing.assert_allclose(rotation_vector(row), wanted, rtol=1e-14, atol=1e-30)
            assert rotation_vector(row[None, None]).shape == (1, 1, 3)


@pytest.mark.parametrize("shape", [(2, 3), (8, 3), (1, 5, 3), (2, 2, 3), (9, 3), (2, 1, 3)])
def test_one_quaternion_rotates_a_few_vectors(shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(7)
    q, v = normalized(rng.normal(size=4)), rng.normal(size=shape)
    for unit in (q, q[None], q[None, None]):
        found = rotate(unit, v)
        assert found.shape == np.broadcast_shapes(unit[..., :3].shape, shape)
        np.testing.assert_allclose(found, columns.rotate(unit, v), rtol=1e-13, atol=1e-15)


def test_a_few_vectors_are_rotated_with_plain_numbers() -> None:
    assert singles.are_few(np.zeros(3))
    assert singles.are_few(np.zeros((1, 8, 3)))
    assert not singles.are_few(np.zeros((9, 3)))
    assert not singles.are_few(np.zeros((5, 1, 3)))


def test_sums_of_negative_zeros_are_zero() -> None:
    assert not np.signbit(rotate([0.0, 0.0, 0.0, 1.0], [-0.0, -0.0, -0.0])).any()
    assert not np.signbit(quaternion_multiply([-0.0] * 4, [0.0] * 4)).any()


@pytest.mark.parametrize("vector", [[0.0, 0.0, 0.0], [1.0, np.nan, 0.0], [np.inf, 0.0, 0.0]])
def test_a_vector_without_direction_has_no_unit_vector(vector: list[float]) -> None:
    with pytest.raises(ValueError, match="cannot normalise a vector"):
        normalized(vector)


def test_a_zero_quaternion_does_not_turn() -> None:
    with pytest.raises(ValueError, match="cannot normalise a quaternion"):
        integrate([0.0] * 4, [1.0, 0.0, 0.0], 0.1)
