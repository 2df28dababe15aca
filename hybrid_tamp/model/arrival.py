"""Rollouts of a block from many initial states at once, each until the exit conditions of the block hold.

One call evaluates an exit condition for a chunk of control steps, because a call costs as much as a control step.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Hyperparameters, Parameters
from hybrid_tamp.model.forward_model import STILL, STILL_STEPS, ForwardModel, exits_hold
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray

_CHUNK = 24
"""Number of control steps between two evaluations of the exit conditions. Each evaluation covers all steps between."""
_SLACK = 1e-6


@dataclass(frozen=True, eq=False)
class Arrivals:
    """The ends of k rollouts.

    Attributes:
        steps: number of control steps until the exit conditions hold, or until the rollout ends. Shape ``(k,)``.
        ends: states after these steps. Batch shape ``(k,)``.
    """

    steps: NDArray[np.int64]
    ends: State


def roll_out_to_exit(block: Block, binding: Binding, starts: State, hyperparameters: Hyperparameters) -> Arrivals:
    """Roll out a block from each of k states until the exit conditions hold.

    A rollout also ends if nothing has moved for many control steps, or at the longest duration of the block.

    Args:
        block: block that is rolled out.
        binding: maps each role of the block to its token or symbol.
        starts: initial states, batch shape ``(k,)``.
        hyperparameters: maps each hyperparameter to its values, shape ``(k,)``.

    Raises:
        DomainError: a function of the domain raised an exception, or returned a result of the wrong shape.
    """
    most, least = (_whole(seconds) for seconds in (block.duration.maximum, block.duration.minimum))
    count, done, state = len(starts.values), 0, starts
    model = ForwardModel(block, binding, starts, Parameters(hyperparameters))
    steps, quiet = np.full(count, most, dtype=np.int64), np.zeros(count, dtype=np.int64)
    ends, pending = starts.values.copy(), np.ones(count, dtype=bool)
    while pending.any() and done < most:
        values = [state.values]
        for step in range(done, min(done + _CHUNK, most)):
            state = model.step(np.float64(step * CONTROL_PERIOD), state)[0]
            values.append(state.values)
        chunk, taken = np.array(values), len(values) - 1
        holds = exits_hold(block, binding, State(starts.layout, chunk[1:]))
        holds &= (np.arange(done + 1, done + taken + 1) >= least)[:, None]
        moves = np.abs(np.diff(chunk, axis=0)).max(axis=(0, 2), initial=0.0) >= STILL
        quiet, done = np.where(moves, 0, quiet + taken), done + taken
        found = holds.any(axis=0)
        last = np.where(found, holds.argmax(axis=0), taken - 1)
        over = np.flatnonzero(pending & (found | ((quiet >= STILL_STEPS) & (done >= least)) | (done >= most)))
        steps[over] = done - taken + 1 + last[over]
        ends[over] = chunk[1 + last[over], over]
        pending[over] = False
    return Arrivals(steps, State(starts.layout, ends))


def stack_values(values: Sequence[Hyperparameters]) -> dict[str, FloatArray]:
    """Return the values of several instances of a block as one array ``(k,)`` for each hyperparameter."""
    return {name: np.array([float(each[name]) for each in values]) for name in values[0]}


def _whole(seconds: float) -> int:
    return int(np.ceil(seconds / CONTROL_PERIOD - _SLACK))
