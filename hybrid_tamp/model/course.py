"""Courses: the poses of an instance's tokens along the reference of its movement, without a rollout."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.control import CONTROL_PERIOD, Parameters
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray

ALLOWANCE = 5e-3
"""Default allowance of a course [m]."""
SKEW = 0.1
"""Largest difference between the times of a pose in a rollout and in a course with times [s]."""
_SPACING = 8 * CONTROL_PERIOD
"""Usual time between two states of a course [s]."""


@dataclass(frozen=True, eq=False)
class Course:
    """The states that an instance passes if nothing disturbs it, in order. Between two states, poses change uniformly.

    Only the poses matter.

    Attributes:
        states: states of the instance's tokens from the start to the expected end, at least one. Shape ``(k,)``.
        allowance: largest distance of a point of a body in a rollout from its place in the nearest state [m].
        times: elapsed times of the states [s], shape ``(k,)``. A rollout reaches each pose up to `SKEW` earlier or
            later. If None, the course says only where the tokens move, and not when.
    """

    states: State
    allowance: float = ALLOWANCE
    times: FloatArray | None = None

    @classmethod
    def through(
        cls,
        start: State,
        values: Mapping[tuple[str, str], FloatArray],
        allowance: float = ALLOWANCE,
        times: FloatArray | None = None,
    ) -> "Course":
        """Return the course in which only some properties change.

        Args:
            start: state at the beginning, without batch dimensions.
            values: maps pairs of (token, property) to the values of the property along the course, shape ``(k, ...)``.
            allowance: see `Course`.
            times: see `Course`.
        """
        count = max(len(each) for each in values.values())
        return cls(start.repeated(count).replace(values), allowance, times)

    @property
    def end(self) -> State:
        """The state at the end, without batch dimensions."""
        return State(self.states.layout, self.states.values[-1])

    def paced(self, seconds: float) -> State:
        """Return the states ``(t,)`` at each control period of a movement that takes some seconds.

        A course without times is passed uniformly from state to state.
        """
        layout, values = self.states.layout, self.states.values.copy()
        turns = [columns for (_, name), columns in layout.slices.items() if name == "orientation"]
        for columns in turns:  # A quaternion and its negative are the same orientation.
            flips = np.sign((values[1:, columns] * values[:-1, columns]).sum(axis=1, keepdims=True))
            values[1:, columns] *= np.cumprod(np.where(flips < 0.0, -1.0, 1.0), axis=0)
        times = np.linspace(0.0, seconds, len(values)) if self.times is None else self.times
        instants = np.arange(round(seconds / CONTROL_PERIOD) + 1) * CONTROL_PERIOD
        found = np.stack([np.interp(instants, times, column) for column in values.T], axis=1)
        for columns in turns:
            found[:, columns] /= np.linalg.norm(found[:, columns], axis=1, keepdims=True)
        return State(layout, found)


SweepMaker = Callable[[Binding, State, Parameters], Course | None]
"""``sweep(binding, start, parameters)`` returns the course of an instance, or None if no reference tells it.

The start has no batch dimensions.
"""


def sample_times(duration: FloatArray | float) -> FloatArray:
    """Return instants of a movement from its start to its end [s], shape ``(k,)``. The duration has no dimensions."""
    count = max(int(np.ceil(float(duration) / _SPACING)), 1)
    return np.linspace(0.0, float(duration), count + 1)
