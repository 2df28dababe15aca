"""Forward models, which simulate the continuous system of a block under its policy for a batch of states."""

from collections.abc import Iterable
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands, Parameters
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.shapes import check_commands, check_shape, sizes_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.model.view import View
from hybrid_tamp.motion.arrays import FloatArray

BoolArray = NDArray[np.bool_]

_HUGE = 1e300
"""Largest squared norm of a finite command. A command with a larger norm is treated as infinite."""


class ForwardModel:
    """The policy and the continuous system of one instance, for states of batch shape ``(...)``."""

    def __init__(self, block: Block, binding: Binding, start: State, parameters: Parameters) -> None:
        """Create the policy and the continuous system from the state at the start of the instance."""
        self._names, self._binding = (f"{block.name}.policy", f"{block.name}.system"), binding
        self._view = View(binding, start.layout)
        seen = self._view.of(start)
        with authored(self._names[0], binding):
            self._policy = None if block.policy is None else block.policy(binding, seen, parameters)
        with authored(self._names[1], binding):
            self._system = block.system_maker(binding, seen)
        held = {slot.name: token for slot in block.slots if isinstance(token := binding[slot.name], Token)}
        self._limits = _limits(held.values())
        self._sizes = sizes_of(held)
        self._sound = np.ones(start.values.shape[:-1], dtype=bool)
        self._sound.flags.writeable = False

    def step(self, elapsed: FloatArray, state: State, dt: float = CONTROL_PERIOD) -> tuple[State, Commands, BoolArray]:
        """Return the next state, the limited commands, and whether both the state and the commands are finite.

        A command above its limit is scaled down. If the next state is not finite, the current state is returned, so
        that later computations remain finite.

        Args:
            elapsed: time since the start of the instance [s], shape ``()`` or ``(...)``.
            state: current state.
            dt: time step [s].

        Raises:
            DomainError: the policy or the system raised an exception, or returned a result of the wrong shape.
        """
        seen = self._view.of(state)
        with authored(self._names[0], self._binding):
            commands = {} if self._policy is None else self._policy(elapsed, seen)
        check_commands(self._names[0], self._binding, commands, self._sizes, seen)
        finite = self._sound
        for key, command in commands.items():
            square, limit = np.einsum("...i,...i->...", command, command), self._limits.get(key, np.inf)
            # This comparison is also false for infinities and NaNs.
            if not np.maximum.reduce(square, axis=None) <= min(limit**2, _HUGE):
                sound = np.asarray(np.isfinite(command).all(axis=-1))
                finite = finite & sound
                commands[key] = _limited(np.where(sound[..., None], command, 0.0), limit)
        with authored(self._names[1], self._binding):
            after = self._system(seen, commands, dt)
        check_shape(self._names[1], self._binding, after.values, seen.values.shape)
        if not isfinite(np.add.reduce(after.values, axis=None)):
            finite = finite & np.isfinite(after.values).all(axis=-1)
            after = State(after.layout, np.where(finite[..., None], after.values, seen.values))
        return self._view.update(state, after), commands, finite


STILL = 1e-9
"""Largest change of a property in a time step at which a state is still, in SI units."""
STILL_STEPS = 240
"""Number of still time steps after which a rollout ends, because the exit conditions will not be reached."""


def roll_out(
    block: Block,
    binding: Binding,
    start: State,
    longest: float,
    dt: float = CONTROL_PERIOD,
    every: int = 1,
) -> list[State]:
    """Simulate a block with the initial values of its hyperparameters until its exit conditions hold.

    The simulation also ends if nothing has moved for many time steps.

    Args:
        block: block to simulate.
        binding: maps each role of the block to its token or symbol.
        start: initial state, without batch dimensions.
        longest: largest simulated time [s].
        dt: time step [s].
        every: number of steps between two checks of the exit conditions.

    Returns:
        The initial state and the state after each step.
    """
    model = ForwardModel(block, binding, start, Parameters(block.initial_values(binding, start)))
    states, still = [start], 0
    while (elapsed := (len(states) - 1) * dt) < longest:
        if len(states) % every == 0 and elapsed >= block.duration.minimum and exits_hold(block, binding, states[-1]):
            break
        states.append(model.step(np.float64(elapsed), states[-1], dt)[0])
        still = still + 1 if np.abs(states[-1].values - states[-2].values).max() < STILL else 0
        if still >= STILL_STEPS and elapsed >= block.duration.minimum:
            break
    return states


def exits_hold(block: Block, binding: Binding, state: State) -> BoolArray:
    """Return whether all measured exit conditions hold in states with any batch shape ``(...)``."""
    holds = np.ones(state.values.shape[:-1], dtype=bool)
    for literal in block.measured_exits:
        holds &= literal.margin(state, binding) >= 0
    return holds


def _limited(command: FloatArray, limit: float) -> FloatArray:
    """Return the command, scaled down if its norm exceeds the limit. Execution scales commands in the same way."""
    command = np.ascontiguousarray(command)
    norm = np.sqrt(np.einsum("...i,...i->...", command, command))
    return np.asarray(command * np.minimum(1.0, limit / np.maximum(norm, limit))[..., None])


def _limits(tokens: Iterable[Token]) -> dict[tuple[str, str], float]:
    """Return a mapping from pairs of (token, basic action) to the largest norm of the command, if there is a limit."""
    return {
        (token.name, action.name): float(token[action.limit])
        for token in tokens
        for action in token.basic_actions
        if action.limit is not None
    }
