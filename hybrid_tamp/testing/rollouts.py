"""Rollouts of a block for several values of its hyperparameters at once."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import Parameters
from hybrid_tamp.model.expectation import declared_duration
from hybrid_tamp.model.forward_model import BoolArray, ForwardModel, exits_hold
from hybrid_tamp.model.predicate import Binding, Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.model.view import View
from hybrid_tamp.motion.arrays import FloatArray

_CHUNK = 48
"""Number of time steps between two tests of the exit conditions. Each test covers all states of the chunk."""
_LONGEST_HOLD = 30.0
"""Longest rollout of a block that can continue after its exit conditions hold [s]."""
_SLOWEST = 2
"""Longest duration of a rollout with drawn hyperparameters, as a multiple of the duration with initial values."""
_STILL = 1e-7
"""A state is at rest if no property changes by more than this value in a time step, in SI units."""
_QUIET = 1.0
"""Time at rest after which a row ends if its block declares no duration [s]."""
_INITIAL = 0.5
"""Probability with which a hyperparameter keeps its initial value, so that some rollouts reach their exits."""


@dataclass(frozen=True, eq=False)
class Rollouts:
    """Rollouts of one block from one state, one for each row of hyperparameters. Row 0 has the initial values.

    Attributes:
        block: block that was rolled out.
        binding: maps each role of the block to its token or symbol.
        start: state before the rollouts, without batch dimensions.
        states: states over time, shape ``(t, n)``. The states of a row after its end are meaningless.
        lengths: number of time steps of each row until its exit conditions hold, or until the row ends without success,
            shape ``(n,)``.
        reached: whether the exit conditions of each row hold at its end, shape ``(n,)``.
        dt: time step [s].
        chosen: maps each hyperparameter to its values, shape ``(n,)``.
    """

    block: Block
    binding: Binding
    start: State
    states: State
    lengths: NDArray[np.int64]
    reached: BoolArray
    dt: float
    chosen: Mapping[str, FloatArray]

    @property
    def rows(self) -> list[int]:
        """Indices of the rows that reached their exit conditions."""
        return [int(row) for row in np.flatnonzero(self.reached)]

    def sample(self, row: int, most: int) -> NDArray[np.int64]:
        """Return the indices of at most `most` states of a row, from its start to its end."""
        last = int(self.lengths[row])
        return np.unique(np.linspace(0, last, min(most, last + 1)).astype(int))

    def end(self, row: int) -> State:
        """Return the final state of a row."""
        return State(self.states.layout, self.states.values[self.lengths[row], row])

    @property
    def ends(self) -> State:
        """Final states of the rows that reached their exit conditions, shape ``(m,)``."""
        return State(self.states.layout, self.states.values[self.lengths[self.rows], self.rows])

    def least(self, literal: Literal) -> float:
        """Return the least margin of a condition in the rows that reached their exit conditions."""
        margins = np.broadcast_to(literal.margin(self.states, self.binding), self.states.values.shape[:-1])
        return float(min(margins[: self.lengths[row] + 1, row].min() for row in self.rows))

    def varies(self, literal: Literal) -> float:
        """Return the difference between the largest and the least margin of a condition in row 0."""
        margins = np.broadcast_to(literal.margin(self.states, self.binding), self.states.values.shape[:-1])
        return float(np.ptp(margins[: self.lengths[0] + 1, 0]))


def draw_hyperparameters(
    block: Block, binding: Binding, state: State, count: int, rng: np.random.Generator
) -> dict[str, FloatArray]:
    """Return the values of each hyperparameter, shape ``(1 + count,)``. Row 0 contains the initial values.

    Every other row draws each hyperparameter uniformly from its range, or keeps its initial value.
    """
    chosen, seen = {}, View(binding, state.layout).of(state)
    for hyperparameter in block.hyperparameters:
        initial = float(block.initial_value(hyperparameter, binding, seen))
        low, high = hyperparameter.bounds(binding)
        drawn = rng.uniform(min(low, high), max(low, high), count)
        chosen[hyperparameter.name] = np.append(initial, np.where(rng.random(count) < _INITIAL, initial, drawn))
    return chosen


def roll_out_rows(
    block: Block, binding: Binding, start: State, chosen: Mapping[str, FloatArray], count: int, dt: float
) -> Rollouts:
    """Roll out a block until the exit conditions of every row hold, or the longest duration of the block is over.

    A row also ends if its state is at rest after the declared duration and after the least duration of the block. If
    the block declares no duration, the row ends after `_QUIET` at rest. If row 0 succeeds, all rows end at the latest
    after `_SLOWEST` times the duration of row 0.

    Args:
        block: block that is rolled out.
        binding: maps each role of the block to its token or symbol.
        start: state before the rollouts, without batch dimensions.
        chosen: maps each hyperparameter to its values, shape ``(count,)``.
        count: number of rows.
        dt: time step [s].
    """
    longest = min(block.duration.maximum, _LONGEST_HOLD) if block.hold else block.duration.maximum
    most, least = int(np.ceil(longest / dt - 1e-6)), int(np.ceil(block.duration.minimum / dt - 1e-6))
    declared = [_declared(block, binding, start, chosen, row) for row in range(count)]
    state = start.repeated(count)
    model = ForwardModel(block, binding, state, Parameters(chosen))
    history = [state.values]
    lengths, reached, running = np.full(count, most), np.zeros(count, bool), np.ones(count, bool)
    quiet = np.zeros(count)
    while running.any() and len(history) <= most:
        begun = len(history)
        while len(history) < min(begun + _CHUNK, most + 1):
            state, _, finite = model.step(np.float64((len(history) - 1) * dt), state, dt)
            history.append(state.values)
            running &= finite
        passed = len(history) - 1
        chunk = State(start.layout, np.array(history[begun:]))
        done = exits_hold(block, binding, chunk) & (np.arange(begun, passed + 1) >= least)[:, None] & running
        found = done.any(axis=0)
        lengths[found], reached[found] = begun + done.argmax(axis=0)[found], True
        still = np.abs(np.diff(chunk.values, axis=0)).max(axis=(0, 2), initial=0.0) < _STILL
        quiet = np.where(still, quiet + (passed + 1 - begun) * dt, 0.0)
        late = np.where(np.isinf(declared), quiet >= _QUIET, passed * dt > np.array(declared))
        halted = running & ~found & still & late & (passed > least)
        lengths[halted] = passed
        running &= ~found & ~halted
        if reached[0] and passed >= _SLOWEST * lengths[0]:
            break
    lengths = np.minimum(lengths, len(history) - 1)
    return Rollouts(block, binding, start, State(start.layout, np.array(history)), lengths, reached, dt, chosen)


def _declared(block: Block, binding: Binding, start: State, chosen: Mapping[str, FloatArray], row: int) -> float:
    """Return the declared duration of a row [s], or infinity."""
    seconds = declared_duration(block, binding, start, {name: values[row] for name, values in chosen.items()})
    return np.inf if seconds is None else seconds
