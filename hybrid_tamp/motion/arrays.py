"""The array type that everything numeric shares."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
"""An array of floats; its shape is said where it is used."""
