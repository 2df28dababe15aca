"""Policies with their parameters, and continuous systems (paper, Sec. II-B)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray

CONTROL_PERIOD = 1 / 240
"""Period of the commands and of the measurements of conditions [s]."""

Commands = dict[tuple[str, str], FloatArray]
"""Maps each pair of (token, basic action) to a command in the unit of the action, shape ``(..., size)``."""

Hyperparameters = Mapping[str, FloatArray]
"""Maps each hyperparameter to its value in the unit of the hyperparameter, shape ``(...)``."""


@dataclass(frozen=True, eq=False)
class Parameters:
    """The parameters of the policy of one instance.

    Attributes:
        hyperparameters: maps each hyperparameter to its value, shape ``(...)``.
        path: corners of a path ``(n, 3)`` [m] for the position of the token in the slot `Block.path`, or None. The
            policy replaces the first corner by the actual start, and the last corner by the actual goal.
        phase: initial phase, shape ``(...)``. 0 is the start of the movement. Not used by any block yet.
    """

    hyperparameters: Hyperparameters
    path: FloatArray | None = None
    phase: FloatArray | float = 0.0

    @classmethod
    def along(cls, path: Sequence[Sequence[float]], hyperparameters: Hyperparameters) -> "Parameters":
        """Return the parameters of a movement along the corners ``(n, 3)`` [m] of a path, which may be empty."""
        return cls(hyperparameters, np.array(path) if path else None)


@dataclass(frozen=True)
class Hyperparameter:
    """A bounded scalar parameter of a policy.

    Attributes:
        name: name of the hyperparameter, e.g. ``"speed"``.
        unit: SI unit.
        lower: lower bound [unit].
        upper: upper bound [unit].
        initial: function ``initial(binding, start)`` that returns the initial value [unit], shape ``(...)``.
        description: description in one line.
        within: function ``within(binding)`` that returns narrower bounds [unit], or None.
    """

    name: str
    unit: str
    lower: float
    upper: float
    initial: Callable[[Binding, State], FloatArray]
    description: str = ""
    within: Callable[[Binding], tuple[float, float]] | None = None

    def bounds(self, binding: Binding) -> tuple[float, float]:
        """Return the lower and the upper bound [unit] for the tokens of a binding."""
        if self.within is None:
            return self.lower, self.upper
        low, high = self.within(binding)
        return float(np.clip(low, self.lower, self.upper)), float(np.clip(high, self.lower, self.upper))

    def initial_value(self, binding: Binding, state: State) -> FloatArray:
        """Return the initial value, clipped to the bounds."""
        return np.clip(self.initial(binding, state), *self.bounds(binding))


class Policy(Protocol):
    """A feedback law that maps elapsed time and state to commands. A policy has no memory."""

    def __call__(self, elapsed: FloatArray, state: State) -> Commands:
        """Return the commands. `elapsed` is the time since the start of the instance [s], shape ``(...)``."""
        ...


class ContinuousSystem(Protocol):
    """The motion of the tokens of one instance, as a pure function without memory."""

    def __call__(self, state: State, commands: Commands, dt: float) -> State:
        """Return the state after a time step `dt` [s] under the commands."""
        ...


PolicyMaker = Callable[[Binding, State, Parameters], Policy]
"""Function ``policy(binding, start, parameters)`` that returns a policy. `start` is the initial state."""

SystemMaker = Callable[[Binding, State], ContinuousSystem]
"""Function ``system(binding, start)`` that returns a continuous system. `start` is the initial state."""
