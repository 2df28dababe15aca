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
