"""References by time alone, evaluated for many control periods at once, and durations in whole milliseconds."""

from collections.abc import Callable

import numpy as np

from hybrid_tamp.authoring import CONTROL_PERIOD, FloatArray, State

_ROWS = 64
"""Number of control periods that are evaluated at once."""

Reference = Callable[[FloatArray], tuple[FloatArray, ...]]
"""Elapsed times ``(...)`` [s] to quantities, each ``(..., d)``."""


class Timetable:
    """A cache of a reference at whole control periods: 64 of them cost little more than one.

    Its values depend on the elapsed time only, not on earlier calls.
    """

    def __init__(self, read: Reference, start: State) -> None:
        """Wrap a reference for states of the same batch shape as `start`."""
        self._read = read
        self._batch = start.values.ndim - 1
        self._page = -1
        self._table: tuple[FloatArray, ...] = ()

    def __call__(self, elapsed: FloatArray) -> tuple[FloatArray, ...]:
        """Return the quantities at an elapsed time [s]: a scalar, or one for each member of the batch ``(...)``."""
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


def round_up(seconds: FloatArray | float) -> float:
    """Round a duration [s] up to whole milliseconds, in which schedules count."""
    return float(np.ceil(1e3 * seconds) / 1e3)
