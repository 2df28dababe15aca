"""Cached evaluation of time-dependent references, and rounding of durations."""

from collections.abc import Callable

import numpy as np

from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.columns import stored_by_column

_ROWS = 64
"""Largest number of control periods that are evaluated at once."""
_VALUES = 16384
"""Largest number of control periods times states that are evaluated at once. More would not fit into the caches."""

Reference = Callable[[FloatArray], tuple[FloatArray, ...]]
"""Maps elapsed times ``(...)`` [s] to a tuple of quantities, each ``(..., d)``."""


class Timetable:
    """A cache of a reference's values at whole control periods. Evaluating 64 periods takes little longer than one.

    The values that a timetable returns do not depend on earlier calls.
    """

    def __init__(self, read: Reference, start: State) -> None:
        """Wrap a reference for states with the batch shape of `start`."""
        self._read = read
        self._batch = start.values.ndim - 1
        self._rows = max(1, min(_ROWS, _VALUES // max(1, start.values[..., 0].size)))
        self._page = -1
        self._table: tuple[FloatArray, ...] = ()

    def __call__(self, elapsed: FloatArray) -> tuple[FloatArray, ...]:
        """Return the quantities at an elapsed time [s], which is a scalar or has the shape of the batch ``(...)``."""
        if np.ndim(elapsed) > 0:
            return self._read(elapsed)
        place = float(elapsed) / CONTROL_PERIOD
        step = round(place)
        if step < 0 or abs(place - step) > 1e-6:
            return self._read(np.asarray(elapsed))
        page, row = divmod(step, self._rows)
        if page != self._page:
            times = np.asarray((page * self._rows + np.arange(self._rows)) * CONTROL_PERIOD, dtype=np.float64)
            read = self._read(times.reshape(-1, *(1,) * self._batch))
            self._table = tuple(stored_by_column(quantity) for quantity in read)
            self._page = page
        return tuple([quantity[row] for quantity in self._table])


def round_up(seconds: FloatArray | float) -> float:
    """Round a duration [s], one number ``()``, up to whole milliseconds, the time unit of schedules."""
    return float(np.ceil(1e3 * seconds) / 1e3)
