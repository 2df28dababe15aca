"""The check of finite values."""

import numpy as np
import pytest

from hybrid_tamp.motion.arrays import are_finite


@pytest.mark.parametrize("values", [[], [0.0, -3.0], [1e308, 1e308, 1e308], [-1e308] * 3])
def test_finite_values_are_finite(values: list[float]) -> None:
    assert are_finite(np.array(values))


@pytest.mark.parametrize("values", [[np.nan], [1.0, np.inf], [np.inf, -np.inf], [1e308, 1e308, np.nan]])
def test_other_values_are_not(values: list[float]) -> None:
    assert not are_finite(np.array(values))
