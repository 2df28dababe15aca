"""Type of numeric arrays."""

import math

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
"""Array of floats. The docstrings of functions state the shapes."""
BoolArray = NDArray[np.bool_]
"""Array of booleans."""


def are_finite(values: FloatArray) -> bool:
    """Return whether all values of a row ``(n,)`` are finite."""
    # The sum of plain numbers takes less time than calls of numpy. It is finite unless large numbers overflow.
    return math.isfinite(sum(values.tolist())) or bool(np.isfinite(values).all())
