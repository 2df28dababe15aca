"""Observed states of all tokens over time, with an estimate of the measurement noise."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.affordance import BODY_STATE
from hybrid_tamp.model.predicate import Literal, Value
from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

Truth = NDArray[np.bool_]
"""Mask of the rows in which a condition holds. Shape ``(t,)``."""

SMOOTHING = 0.02
"""Window over which poses and velocities are averaged, in seconds. Every block lasts much longer."""
ALLOWANCE = 0.25
"""Tolerance of observed margins, as a multiple of the predicate's scale."""
SURE = 3.0
"""Tolerance for noise, in standard deviations of a margin."""
_MEDIAN = 0.6745
"""Median of the absolute value of a standard normal variable."""
_LEAST = 1e-4
"""Smallest position noise, in metres. Smaller estimates reflect the movement and are replaced by zero noise."""
_DRAWS = 16
"""Number of random states that represent one noisy state."""
STILL = (0.01, 0.04)
"""Largest changes of (position in metres, orientation in radians) of a token that stays still."""
_ONSET = (0.003, 0.01)
"""Smallest changes of (position in metres, orientation in radians) of a token that has begun to move."""


@dataclass(frozen=True, eq=False)
class Observation:
    """A time series of observed states, before and after smoothing.

    Attributes:
        times: time of each row, in seconds. Shape ``(t,)``.
        trajectory: smoothed state of each row. Batch shape ``(t,)``.
        measured: measured state of each row, before smoothing. Batch shape ``(t,)``.
        allowance: tolerance of observed margins, as a multiple of the predicate's scale.
        deviation: standard deviation of the noise after smoothing, as a state without batch dimensions.
    """

    times: FloatArray
    trajectory: State
    measured: State
    allowance: float
    deviation: State
    _truths: dict[object, Truth] = field(default_factory=dict, repr=False)

    @classmethod
    def of(
        cls, times: FloatArray, trajectory: State, allowance: float = ALLOWANCE, deviation: State | None = None
    ) -> "Observation":
        """Return an observation of states that were measured at a constant rate.

        Args:
            times: evenly spaced times, in seconds. Shape ``(t,)``.
            trajectory: measured states. Batch shape ``(t,)``.
            allowance: tolerance of observed margins, as a multiple of the predicate's scale.
            deviation: standard deviation of the noise after smoothing. Estimated by default.
        """
        period = float(times[1] - times[0]) if len(times) > 1 else 1.0
        window = max(1, round(SMOOTHING / period)) | 1
        return cls(
            times,
            State(trajectory.layout, _smoothed(trajectory.layout, trajectory.values, window)),
            trajectory,
            allowance,
            deviation or State(trajectory.layout, _noise(trajectory, period) / np.sqrt(window)),
        )

    @property
    def last(self) -> int:
        """Index of the last row."""
        return len(self.times) - 1

    def row(self, time: float) -> int:
        """Return the first row at or after a time in seconds."""
        return min(int(np.searchsorted(self.times, time - 1e-9)), self.last)

    def at(self, time: float) -> State:
        """Return the measured state nearest to a time in seconds."""
        return State(self.measured.layout, self.measured.values[int(np.argmin(np.abs(self.times - time)))])

    def state(self, row: int) -> State:
        """Return the smoothed state of a row."""
        return State(self.trajectory.layout, self.trajectory.values[row])

    def likely(self, row: int) -> State:
        """Return possible true states of a noisy row, most likely states first. Batch shape ``(n,)``."""
        draws = np.random.default_rng(row).standard_normal((_DRAWS, self.trajectory.layout.size))
        draws *= np.linspace(0.0, SURE, _DRAWS)[:, None]
        return State(self.trajectory.layout, self.trajectory.values[row] + draws * self.deviation.values)

    def truth(self, literal: Literal, binding: dict[str, Value], strict: bool = False, sure: float = SURE) -> Truth:
        """Return a mask of the rows in which the measured states satisfy a condition.

        If ``strict`` is false, the smoothed margin may be negative by at most the allowance plus ``sure`` standard
        deviations of the margin's noise.
        """
        key = (literal.ground(binding), strict, sure)
        if key not in self._truths:
            holds = np.asarray(literal.margin(self.measured, binding) >= 0, dtype=bool)
            if not strict:
                margin = literal.margin(self.trajectory, binding)
                noise = np.median(np.abs(literal.margin(self._shaken, binding) - margin)) / _MEDIAN
                holds = holds | (margin >= -self.allowance * literal.predicate.scale - sure * noise)
            self._truths[key] = np.broadcast_to(holds, self.times.shape)
        return self._truths[key]

    def departure(self, token: str, row: int) -> int:
        """Return the first row after `row` in which the token has left its pose, or a row beyond the last row."""
        moved = np.flatnonzero(self._moved(token, row, STILL)[row:])
        return row + int(moved[0]) if len(moved) else self.last + 1

    def onset(self, token: str, row: int) -> int:
        """Return the last row in which the token still has its pose of `row`."""
        return row + int(np.flatnonzero(~self._moved(token, row, _ONSET)[row : self.departure(token, row)])[-1])

    def place(self, token: str, row: int) -> FloatArray:
        """Return the position of a token in a row, in metres. Shape ``(3,)``."""
        return np.asarray(self.trajectory[token, "position"][row])

    @cached_property
    def _shaken(self) -> State:
        """Smoothed states plus random noise of the estimated size, used to measure how noise affects a margin."""
        draws = np.random.default_rng(0).standard_normal(self.trajectory.values.shape)
        return State(self.trajectory.layout, self.trajectory.values + draws * self.deviation.values)

    def _moved(self, token: str, row: int, tolerances: tuple[float, float]) -> Truth:
        position = self.trajectory[token, "position"]
        moved = np.linalg.norm(position - position[row], axis=-1) > tolerances[0]
        if (token, "orientation") in self.trajectory.layout.slices:
            turned = self.trajectory[token, "orientation"]
            moved = moved | (2.0 * np.arccos(np.minimum(1.0, np.abs(turned @ turned[row]))) > tolerances[1])
        return np.asarray(moved)


@dataclass(frozen=True)
class Shown:
    """A demonstration by another agent.

    Attributes:
        source: name of the folder or file with the demonstration.
        task: the demonstrator's task, whose initial state is the first observed state.
        observation: observed states over time.
    """

    source: str
    task: Task
    observation: Observation


def _noise(trajectory: State, period: float) -> FloatArray:
    """Return the standard deviation of the noise of each column, or zeros if the positions are exact."""
    found = measured_noise(trajectory.values, period)
    places = [found[part] for (_, name), part in trajectory.layout.slices.items() if name == "position"]
    return found if places and max(place.max() for place in places) > _LEAST else np.zeros_like(found)


def measured_noise(values: FloatArray, period: float) -> FloatArray:
    """Return the standard deviation of the noise of each column of ``values``, which have shape ``(t, c)``.

    The estimate uses third differences over a few hundredths of a second, in which movements are almost smooth.
    """
    step = max(1, round(SMOOTHING / period))
    if len(values) <= 3 * step:
        return np.zeros(values.shape[1:])
    bends = values[3 * step :] - 3.0 * values[2 * step : -step] + 3.0 * values[step : -2 * step] - values[: -3 * step]
    return np.asarray(np.median(np.abs(bends), axis=0) / (_MEDIAN * np.sqrt(20.0)))


def _smoothed(layout: StateLayout, values: FloatArray, window: int) -> FloatArray:
    """Average poses and velocities over a window of rows. Other state variables may jump and are not averaged."""
    found = values.copy()
    averaged = {varying.name for varying in BODY_STATE}
    kernel, half = np.ones(window) / window, window // 2
    for (_, name), part in layout.slices.items():
        if name not in averaged or window <= 1:
            continue
        column = values[:, part]
        if name == "orientation":
            flips = np.where(np.sum(column[1:] * column[:-1], axis=-1) < 0, -1.0, 1.0)
            column = column * np.concatenate([[1.0], np.cumprod(flips)])[:, None]
        padded = np.concatenate([np.repeat(column[:1], half, 0), column, np.repeat(column[-1:], half, 0)])
        mean = np.stack([np.convolve(each, kernel, mode="valid") for each in padded.T], axis=-1)
        if name == "orientation":
            mean /= np.linalg.norm(mean, axis=-1, keepdims=True)
        found[:, part] = mean
    return np.asarray(found)
