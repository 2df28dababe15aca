"""Parameters of an instance: hyperparameters with their bounds and initial values (paper, Sec. II-B)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray

Hyperparameters = Mapping[str, FloatArray]
"""Hyperparameter to its value, shape ``(...)``, in its unit."""


@dataclass(frozen=True, eq=False)
class Parameters:
    """What shapes the policy of one instance.

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
        within: ``within(binding)`` to bounds that follow from the tokens, e.g. from the length of a handle, or None;
            they narrow the others.
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
