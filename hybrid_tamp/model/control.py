"""Policies with their parameters, and continuous systems: what drives tokens, and how they move (paper, Sec. II-B)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray

CONTROL_PERIOD = 1 / 240
"""Time between two commands and between two measurements of conditions [s]."""

Commands = dict[tuple[str, str], FloatArray]
"""(token, basic action) to the command, shape ``(..., size)`` in the action's unit."""

Hyperparameters = Mapping[str, FloatArray]
"""Hyperparameter to its value, shape ``(...)``, in its unit."""


@dataclass(frozen=True, eq=False)
class Parameters:
    """The parameters of the policy of one instance.

    Attributes:
        hyperparameters: hyperparameter to its value ``(...)``.
        path: configurations to pass in order, ``(..., n, d)``, or None. No block reads it yet.
        phase: the phase to begin from, ``(...)``; 0 is the beginning. No block reads it yet.
    """

    hyperparameters: Hyperparameters
    path: FloatArray | None = None
    phase: FloatArray | float = 0.0


@dataclass(frozen=True)
class Hyperparameter:
    """A bounded number with a unit that shapes a policy.

    Attributes:
        name: e.g. ``"speed"``.
        unit: SI unit.
        lower: lower bound [unit].
        upper: upper bound [unit].
        initial: ``initial(binding, state)``, the initial value ``(...)`` from the state at the block's beginning.
        description: one line.
        within: ``within(binding)``, narrower bounds from the tokens, e.g. from the length of a handle; or None.
    """

    name: str
    unit: str
    lower: float
    upper: float
    initial: Callable[[Binding, State], FloatArray]
    description: str = ""
    within: Callable[[Binding], tuple[float, float]] | None = None

    def bounds(self, binding: Binding) -> tuple[float, float]:
        """Return the lower and the upper bound [unit] for these tokens."""
        if self.within is None:
            return self.lower, self.upper
        low, high = self.within(binding)
        return float(np.clip(low, self.lower, self.upper)), float(np.clip(high, self.lower, self.upper))

    def initial_value(self, binding: Binding, state: State) -> FloatArray:
        """Return the initial value, clipped to the bounds."""
        return np.clip(self.initial(binding, state), *self.bounds(binding))


class Policy(Protocol):
    """A feedback law: elapsed time and state to basic actions. It has no memory."""

    def __call__(self, elapsed: FloatArray, state: State) -> Commands:
        """Return the commands at `elapsed` [s] since the instance began, shape ``(...)``, in a state ``(...)``."""
        ...


class ContinuousSystem(Protocol):
    """The motion of the tokens in the slots of one instance. It is pure and has no memory."""

    def __call__(self, state: State, commands: Commands, dt: float) -> State:
        """Return the state ``(...)`` after the time step `dt` [s] under the commands."""
        ...


PolicyMaker = Callable[[Binding, State, Parameters], Policy]
"""``policy(binding, start, parameters)`` makes the policy of one instance from the state at its beginning."""

SystemMaker = Callable[[Binding, State], ContinuousSystem]
"""``system(binding, start)`` makes the continuous system of one instance; it computes constants once."""
