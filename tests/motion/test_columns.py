"""Large batches are computed component by component, with the same results as small batches."""

import numpy as np
import pytest

from hybrid_tamp.motion import columns
from hybrid_tamp.motion.poses import (
    cross,
    integrate,
    normalized,
    quaternion_from_axis_angle,
    quaternion_multiply,
    rotate,
)


@pytest.mark.parametrize("shape", [(400,), (20, 30), (3, 200, 2)])
def test_large_batches_equal_their_rows(shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(4)
    a, b = (normalized(rng.normal(size=(*shape, 4))) for _ in range(2))
    u, v = (rng.normal(size=(*shape, 3)) for _ in range(2))
    assert columns.is_large(a, a[0, :1])
    assert not columns.is_large(a[0, :1], u[0, :1])
    for found, alone in (
        (cross(u, v), cross),
        (quaternion_multiply(a, b), quaternion_multiply),
        (rotate(a, u), rotate),
    ):
        one, other = (u, v) if alone is cross else (a, b if alone is quaternion_multiply else u)
        rows = [
            alone(x, y) for x, y in zip(one.reshape(-1, one.shape[-1]), other.reshape(-1, other.shape[-1]), strict=True)
        ]
        np.testing.assert_allclose(found.reshape(-1, found.shape[-1]), rows, rtol=0, atol=1e-14)


def test_large_batches_are_broadcast() -> None:
    rng = np.random.default_rng(5)
    turns = normalized(rng.normal(size=(200, 1, 4)))
    vectors = rng.normal(size=(6, 3))
    found = rotate(turns, vectors)
    assert found.shape == (200, 6, 3)
    np.testing.assert_allclose(found[7, 2], rotate(turns[7, 0], vectors[2]), atol=1e-14)
    assert cross(np.array([0.0, 0.0, 1.0]), rng.normal(size=(200, 3))).shape == (200, 3)


def test_axes_of_unit_length_need_no_normalisation() -> None:
    axis = normalized(np.array([1.0, 2.0, -3.0]))
    angles = np.linspace(-3.0, 3.0, 7)
    assert np.array_equal(
        quaternion_from_axis_angle(axis, angles, unit=True),
        quaternion_from_axis_angle(np.array([1.0, 2.0, -3.0]), angles),
    )


def test_integration_keeps_the_length() -> None:
    turn = np.array([0.0, 0.0, 0.0, 1.0])
    for _ in range(5000):
        turn = integrate(turn, np.array([3.0, -2.0, 5.0]), 1 / 240)
    assert np.linalg.norm(turn) == pytest.approx(1.0, abs=1e-15)
    with pytest.raises(ValueError, match="zero or not finite"):
        integrate(np.zeros(4), np.ones(3), 0.1)


def test_the_order_in_memory_changes_no_bits() -> None:
    rng = np.random.default_rng(8)
    q, r = (normalized(rng.normal(size=(400, 4))) for _ in range(2))
    u, v = (rng.normal(size=(400, 3)) for _ in range(2))
    stored = [columns.stored_by_column(each) for each in (q, r, u, v)]
    assert all(each.T.flags.c_contiguous for each in stored)
    for function, *arguments in ((cross, 2, 3), (rotate, 0, 3), (quaternion_multiply, 0, 1)):
        found = function(*(stored[index] for index in arguments))
        assert found.tobytes() == function(*((q, r, u, v)[index] for index in arguments)).tobytes()
    assert integrate(stored[0], stored[3], 0.1).tobytes() == integrate(q, v, 0.1).tobytes()


def test_small_batches_keep_their_order_in_memory() -> None:
    small = np.zeros((100, 7))
    assert columns.stored_by_column(small) is small
    assert columns.stored_by_column(np.zeros((101, 7))) is not small


def test_the_sum_of_squares_has_the_bits_of_einsum() -> None:
    for size in (3, 4):
        vectors = np.random.default_rng(9).normal(size=(500, size))
        assert columns.sum_squares(vectors).tobytes() == np.einsum("...i,...i->...", vectors, vectors).tobytes()


def test_each_of_many_quaternions_rotates_several_vectors() -> None:
    rng = np.random.default_rng(10)
    q, v = normalized(rng.normal(size=(300, 1, 4))), rng.normal(size=(300, 2, 3))
    together = rotate(q, v)
    for index in range(2):
        assert together[:, index].tobytes() == rotate(q[:, 0], v[:, index]).tobytes()
