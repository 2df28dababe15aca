"""Type of numeric arrays."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
"""Array of floats. The docstrings of functions state the shapes."""
