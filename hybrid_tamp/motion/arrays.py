"""The common type of numeric arrays."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
"""An array of floats; docstrings give its shape."""
