"""References by time alone, read many control periods at once: that costs little more than reading one."""

from collections.abc import Callable

import numpy as np

from hybrid_tamp.authoring import CONTROL_PERIOD, FloatArray, State

_ROWS = 64
"""Control periods that are read at once."""

Reference = Callable[[FloatArray], tuple[FloatArray, ...]]
"""From elapsed times, shape ``(...)``, to quantities, each of shape ``(..., d)``."""


class Timetable:
    """A reference whose values at whole control periods are looked up.

    What it returns follows from the elapsed time alone, whatever it was asked before.
    """

    def __init__(self, read: Reference, start: State) -> None:
        """Make it of a reference for the batch of a state."""
        self._read = read
        self._batch = start.values.ndim - 1
        self._page = -1
        self._table: tuple[FloatArray, ...] = ()

    def __call__(self, elapsed: FloatArray) -> tuple[FloatArray, ...]:
        """Return the quantities at an elapsed time [s], one for all or each its own, shape ``(...)``."""
        if np.ndim(elapsed) > 0:
            return self._read(elapsed)
        place = float(elapsed) / CONTROL_PERIOD
        step = round(place)
        if step < 0 or abs(place - step) > 1e-6:
            return self._read(np.asarray(elapsed))
        page, row = divmod(step, _ROWS)
        if page != self._page:
            times = np.asarray((page * _ROWS + np.arange(_ROWS)) * CONTROL_PERIOD, dtype=np.float64)
            self._table = self._read(times.reshape(-1, *(1,) * self._batch))
            self._page = page
        return tuple(quantity[row] for quantity in self._table)
