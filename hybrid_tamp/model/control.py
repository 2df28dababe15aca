"""Policies and continuous systems: what drives the tokens of a block, and how they move (paper, Sec. II-B)."""

from collections.abc import Callable
from typing import Protocol

from hybrid_tamp.model.parameters import Parameters
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray

CONTROL_PERIOD = 1 / 240
"""Time between two commands [s]: policies are asked, and conditions measured, this often."""

Commands = dict[tuple[str, str], FloatArray]
"""(token, basic action) to the command, shape ``(..., size)`` in the action's unit."""


class Policy(Protocol):
    """A feedback law: elapsed time and state to basic actions. It keeps no memory of its own."""

    def __call__(self, elapsed: FloatArray, state: State) -> Commands:
        """Return the commands.

        Args:
            elapsed: time since the instance began [s], shape ``(...)``.
            state: current state, batch shape ``(...)``.
        """
        ...


class ContinuousSystem(Protocol):
    """How the tokens in the slots of one instance move. It is pure and keeps no memory of its own."""

    def __call__(self, state: State, commands: Commands, dt: float) -> State:
        """Return the next state of the tokens in the block's slots.

        Args:
            state: current state, batch shape ``(...)``.
            commands: what is commanded.
            dt: time step [s].
        """
        ...


PolicyMaker = Callable[[Binding, State, Parameters], Policy]
"""``policy(binding, start, parameters)`` makes the policy of one instance from the state at its beginning."""

SystemMaker = Callable[[Binding, State], ContinuousSystem]
"""``system(binding, start)`` makes the continuous system of one instance; it computes constants once."""
