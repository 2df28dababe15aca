"""A replacement for a random generator that draws bounds of ranges instead of random values."""

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray


class Corner:
    """A generator whose first draws are bounds of ranges. Each bit of the index selects the bound of one draw.

    Later draws, and draws of several values at once, return the middle of the range.
    """

    def __init__(self, index: int, count: int) -> None:
        """Make the generator of a corner.

        Args:
            index: number of the corner, from 0 to ``2 ** count - 1``.
            count: number of draws that return bounds.
        """
        self._bits = [bool(index >> place & 1) for place in reversed(range(count))]

    def uniform(self, low: float, high: float, size: int | None = None) -> float | FloatArray:
        """Return a bound or the middle of the range. The shape is ``(size,)`` if a size is given."""
        if size is None and self._bits:
            return high if self._bits.pop() else low
        middle = (low + high) / 2.0
        return middle if size is None else np.full(size, middle)
