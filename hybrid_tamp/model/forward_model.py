"""Forward models: the continuous system of a block under its policy, for one initial state or a batch of them."""

from collections.abc import Iterable
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands, Parameters
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

BoolArray = NDArray[np.bool_]

_HUGE = 1e300
"""Larger squares are treated as infinite."""


class ForwardModel:
    """The policy and the continuous system of one instance; its states have the batch shape ``(...)``."""

    def __init__(self, block: Block, binding: Binding, start: State, parameters: Parameters) -> None:
        """Make policy and system from the state at the beginning of the instance."""
        self._policy = None if block.policy is None else block.policy(binding, start, parameters)
        self._system = block.system(binding, start)
        held = (binding[slot.name] for slot in block.slots)
        self._limits = _limits(token for token in held if isinstance(token, Token))

    def step(self, elapsed: FloatArray, state: State, dt: float = CONTROL_PERIOD) -> tuple[State, Commands, BoolArray]:
        """Return the next state, the commands within their limits, and whether both are finite ``(...)``.

        A state that would not be finite stays unchanged, so that later computations remain finite.

        Args:
            elapsed: time since the beginning [s], ``()`` or ``(...)``.
            state: current state.
            dt: time step [s].
        """
        commands = {} if self._policy is None else self._policy(elapsed, state)
        finite = np.ones(state.values.shape[:-1], dtype=bool)
        for key, command in commands.items():
            square, limit = np.einsum("...i,...i->...", command, command), self._limits.get(key, np.inf)
            # Infinities and NaNs fail this comparison, too.
            if not np.maximum.reduce(square, axis=None) <= min(limit**2, _HUGE):
                sound = np.asarray(np.isfinite(command).all(axis=-1))
                finite &= sound
                commands[key] = _limited(np.where(sound[..., None], command, 0.0), limit)
        after = self._system(state, commands, dt)
        if not isfinite(np.add.reduce(after.values, axis=None)):
            finite &= np.isfinite(after.values).all(axis=-1)
            after = State(after.layout, np.where(finite[..., None], after.values, state.values))
        return after, commands, finite


def roll_out(
    block: Block, binding: Binding, start: State, longest: float, dt: float = CONTROL_PERIOD, every: int = 1
) -> list[State]:
    """Run a block, with the initial values of its hyperparameters, until its exit conditions hold.

    Args:
        block: the block.
        binding: its roles.
        start: a single state.
        longest: longest duration [s].
        dt: time step [s].
        every: number of steps between two measurements of its exit conditions.

    Returns:
        The state at the beginning and after every step.
    """
    model = ForwardModel(block, binding, start, Parameters(block.initial_values(binding, start)))
    states = [start]
    while (elapsed := (len(states) - 1) * dt) < longest:
        if len(states) % every == 0 and elapsed >= block.duration.minimum and _done(block, binding, states[-1]):
            break
        states.append(model.step(np.float64(elapsed), states[-1], dt)[0])
    return states


def _done(block: Block, binding: Binding, state: State) -> bool:
    return all(float(literal.margin(state, binding)) >= 0 for literal in block.measured_exits)


def _limited(command: FloatArray, limit: float) -> FloatArray:
    """Scale a command down to the limit of its token, as execution does."""
    norm = np.sqrt(np.einsum("...i,...i->...", command, command))
    return np.asarray(command * np.minimum(1.0, limit / np.maximum(norm, limit))[..., None])


def _limits(tokens: Iterable[Token]) -> dict[tuple[str, str], float]:
    """Return (token, basic action) to the largest norm of its command, for actions with a limit."""
    return {
        (token.name, action.name): float(token[action.limit])
        for token in tokens
        for action in token.basic_actions
        if action.limit is not None
    }
