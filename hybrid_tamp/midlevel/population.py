"""Rollouts of one block instance, with many candidates as rows of one array.

A candidate reaches its exit, as in a real run, as soon as all exit conditions hold and the minimum duration has passed.
A candidate that reaches no exit ends at the block's maximum duration, or once its state and commands are constant.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from hybrid_tamp.midlevel.instance_model import InstanceModel, IntArray
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands
from hybrid_tamp.model.forward_model import BoolArray
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.columns import stored_by_column

CHUNK = 48
"""Number of control steps per chunk. The conditions are checked for all states of a chunk at the same time."""
STILL = 1e-7
"""Largest change of a state within a chunk at which the state is treated as being at rest, in SI units."""
_STEADY = 1e-3
"""Largest change of a command within a chunk at which the command is treated as constant, in SI units."""
_EVERY = 8
"""Number of control steps between two poses at which guards are evaluated. A divisor of `CHUNK`."""
_AWAKE = 0.5
"""Time before which no state is treated as being at rest, in seconds, because movements begin slowly."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """Rollouts of one instance until its exit conditions hold, for n candidates.

    Attributes:
        after: final state of the instance's tokens, or the initial state if the rollout failed. Shape ``(n, m)``.
        steps: number of control periods. Shape ``(n,)``.
        exits: final margins of the exit conditions, each in the unit of its predicate. Shape ``(n, e)``.
        lasting: least margins of the invariants and of the guard, each in its own unit. Shape ``(n, i + g)``.
        figures: values of the performance measures. Shape ``(n, p)``.
        finite: whether all computed values are finite. Shape ``(n,)``.
    """

    after: FloatArray
    steps: IntArray
    exits: FloatArray
    lasting: FloatArray
    figures: FloatArray
    finite: BoolArray

    def rows(self, index: IntArray) -> "Stretch":
        """Return the rollouts of the candidates with the given indices."""
        return Stretch(*(getattr(self, field.name)[index] for field in fields(self)))


class Population:
    """The candidates of one rollout in progress, with the results of finished candidates.

    Attributes:
        pending: mask of the candidates that are still running. Shape ``(n,)``.
    """

    def __init__(self, model: InstanceModel, start: FloatArray, chosen: Mapping[str, FloatArray]) -> None:
        self.model = model
        self.measures = model.block.performance
        self.start, self.chosen = start, chosen
        count = len(start)
        self.pending = np.ones(count, dtype=bool)
        self.after = start.copy()
        self.steps = np.zeros(count, dtype=np.int64)
        self.finite = np.ones(count, dtype=bool)
        self.exits = np.full((count, len(model.block.measured_exits)), np.nan)
        self.lasting = np.full((count, len(model.lasting)), np.inf)
        self.figures = np.array([[-np.inf if m.peak else 0.0 for m in self.measures]] * count).reshape(count, -1)
        self.done = 0  # control steps so far
        self.path = [start]  # states of a single candidate, with those after its exit
        self._restrict(np.arange(count))

    def _restrict(self, rows: IntArray) -> None:
        """Continue the rollout with the given rows only."""
        self.rows = rows
        mine = {name: value[rows] for name, value in self.chosen.items()}
        # Policies and systems read properties of all candidates, so a large batch is stored property by property.
        self.running = self.model.start_from(stored_by_column(self.start[rows]), mine)
        self.state = self.model.state(stored_by_column(self.after[rows]))

    def advance(self) -> None:
        """Advance by one chunk of control steps, check the conditions, and store the results of finished candidates."""
        count = min(CHUNK, self.model.longest - self.done)
        values, commanded = [self.state.values], []
        finite = np.ones(len(self.rows), dtype=bool)
        for step in range(self.done, self.done + count):
            elapsed = np.float64(step * CONTROL_PERIOD)
            self.state, commands, sound = self.running.step(elapsed, self.state)
            finite &= sound
            values.append(self.state.values)
            commanded.append(commands)
        chunk = np.stack(values[1:])  # (t, n, m)
        if len(self.start) == 1:
            self.path.append(chunk[:, 0])
        run = self.model.state(chunk)
        elapsed = (self.done + 1 + np.arange(count)) * CONTROL_PERIOD
        reached = self.model.holding(run, elapsed >= self.model.shortest)
        self.done += count
        ends = self.done >= self.model.longest
        still = (np.abs(chunk[-1] - values[0]).max(axis=-1) < STILL) & (self.done * CONTROL_PERIOD > _AWAKE)
        if still.any():
            still &= _steady(commanded)
        last = np.where(reached.any(axis=0), reached.argmax(axis=0), count - 1)
        over = np.asarray(reached.any(axis=0) | ~finite | still | ends)
        self._measure(run, commanded, np.arange(count)[:, None] <= last)
        self._keep_least(run, np.arange(count)[:, None] <= last)
        retired = over & self.pending[self.rows]
        index, local = self.rows[retired], np.flatnonzero(retired)
        self.after[index] = np.where(finite[local, None], chunk[last[local], local], self.start[index])
        if len(index):
            final = self.model.state(chunk[last[local], local])
            self.exits[index] = self.model.exits(final)
            self._lower(index, self.model.clearances(final), len(self.model.block.invariants))
        self.steps[index] = self.done - count + 1 + last[local]
        self.finite[index] = finite[local]
        self.pending[index] = False
        self._drop_retired(chunk[-1])

    def _drop_retired(self, values: FloatArray) -> None:
        """Remove finished candidates from the batch if at least half of the candidates in the batch are finished."""
        left = self.pending[self.rows]
        self.after[self.rows[left]] = values[left]
        if left.any() and 2 * np.count_nonzero(left) <= len(left):
            self._restrict(self.rows[left])

    def _measure(self, run: State, commanded: list[Commands], counted: BoolArray) -> None:
        """Update the peaks and integrals of the measures with those states of a chunk that `counted` selects."""
        counted = counted & self.pending[self.rows]
        name, binding = self.model.block.name, self.model.binding
        for column, measure in enumerate(self.measures):
            mine = self.figures[self.rows, column]
            if measure.peak is not None:
                peaks = measure.during(name, binding, run, {})
                figure = np.where(counted, peaks, -np.inf).max(axis=0)
                self.figures[self.rows, column] = np.maximum(mine, figure)
            elif measure.rate is not None:
                commands = {key: np.stack([each[key] for each in commanded]) for key in commanded[0]}
                rate = np.where(counted, measure.during(name, binding, run, commands), 0.0)
                self.figures[self.rows, column] = mine + rate.sum(axis=0) * CONTROL_PERIOD

    def _keep_least(self, run: State, counted: BoolArray) -> None:
        """Update the least margins of invariants and guard with those states of a chunk that `counted` selects."""
        counted = counted & self.pending[self.rows]
        self._lower(self.rows, _least(self.model.invariants(run), counted))
        if self.model.guard.literals:
            sampled, within = self.model.state(run.values[_EVERY - 1 :: _EVERY]), counted[_EVERY - 1 :: _EVERY]
            self._lower(self.rows, _least(self.model.clearances(sampled), within), len(self.model.block.invariants))

    def _lower(self, rows: IntArray, margins: FloatArray, first: int = 0) -> None:
        """Lower the least margins of some candidates, from the column `first` on."""
        columns = slice(first, first + margins.shape[-1])
        self.lasting[rows, columns] = np.minimum(self.lasting[rows, columns], margins)

    def stretch(self) -> Stretch:
        """Return the results of all candidates."""
        before, after = self.model.state(self.start), self.model.state(self.after)
        for column, measure in enumerate(self.measures):
            if measure.end is not None:
                name, binding = self.model.block.name, self.model.binding
                self.figures[:, column] = measure.at_end(name, binding, before, after, self.chosen)
        finite = self.finite & np.isfinite(self.figures).all(axis=1) & np.isfinite(self.exits).all(axis=1)
        return Stretch(self.after, self.steps, self.exits, self.lasting, self.figures, finite)


def _steady(commanded: Sequence[Commands]) -> BoolArray:
    """Return a mask of the candidates with constant commands in a chunk. Changing commands can cause motion."""
    changes = [np.abs(commanded[-1][key] - first).max(axis=-1) for key, first in commanded[0].items()]
    return np.asarray(np.logical_and.reduce([change < _STEADY for change in changes], initial=True), dtype=bool)


def _least(margins: FloatArray, counted: BoolArray) -> FloatArray:
    """Return the least margins ``(n, i)`` of the states ``(t, n)`` of a chunk that `counted` selects."""
    return np.asarray(np.where(counted[..., None], margins, np.inf).min(axis=0, initial=np.inf))
