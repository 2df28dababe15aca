"""The model of one block instance, and its candidates, rolled out together as rows of one array.

As in a real run, a candidate reaches its exit at the first control step at which its minimum duration has passed and
all exit conditions hold. Otherwise it ends at the block's maximum duration, or when it and its commands are at rest.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from math import floor

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands, Parameters
from hybrid_tamp.model.forward_model import BoolArray, ForwardModel
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

IntArray = NDArray[np.int64]

CHUNK = 48
"""Number of control steps between checks of the conditions: many states cost little more than one."""
STILL = 1e-7
"""A state that changes by less than this within a chunk is at rest [SI units]."""
_STEADY = 1e-3
"""A command that changes by less than this within a chunk is constant [SI units]."""
_AWAKE = 0.5
"""Time before which nothing counts as at rest [s]: movements begin slowly."""


class InstanceModel:
    """The model of one instance of a plan.

    Attributes:
        instance: the instance.
        block: its block.
        binding: its roles.
        columns: indices of the state of its roles' tokens in a row of the task's state, shape ``(m,)``.
        held: whether each of these columns belongs to a token in a slot, shape ``(m,)``.
        longest: maximum number of control steps.
        shortest: minimum duration [s].
    """

    def __init__(self, task: Task, instance: BlockInstance) -> None:
        self.instance = instance
        self.block: Block = task.domain.block_by_name[instance.block]
        self.binding = task.bind(instance.roles)
        tokens = {value.name: value for value in self.binding.values() if isinstance(value, Token)}
        layout, full = StateLayout.of(tokens.values()), task.state.layout.slices
        places = [range(*full[token, name].indices(task.state.layout.size)) for token, name, _ in layout.entries]
        self.columns = np.array([index for place in places for index in place], dtype=np.intp)
        slots = set(instance.slots.values())
        self.held = np.array([token in slots for token, _, size in layout.entries for _ in range(size)], dtype=bool)
        self._layout = layout
        self.longest = floor(self.block.duration.maximum / CONTROL_PERIOD + 1e-6)
        self.shortest = self.block.duration.minimum - 1e-6

    def state(self, rows: FloatArray) -> State:
        """Return rows ``(..., m)`` as the state of the instance's tokens."""
        return State(self._layout, rows)

    def exits(self, state: State) -> FloatArray:
        """Return the margins of the exit conditions, shape ``(..., e)``."""
        return self._margins(self.block.measured_exits, state)

    def entries(self, state: State) -> FloatArray:
        """Return the margins of the entry conditions that are measured, shape ``(..., e)``."""
        return self._margins(self.block.measured_entries, state)

    def _margins(self, literals: Sequence[Literal], state: State) -> FloatArray:
        batch = state.values.shape[:-1]
        margins = [np.broadcast_to(literal.margin(state, self.binding), batch) for literal in literals]
        return np.stack(margins, axis=-1) if margins else np.zeros((*batch, 0))

    def start_from(self, start: FloatArray, chosen: Mapping[str, FloatArray]) -> ForwardModel:
        """Make its policy and system for states ``(n, m)`` at its beginning."""
        return ForwardModel(self.block, self.binding, self.state(start), Parameters(chosen))


@dataclass(frozen=True, eq=False)
class Stretch:
    """The rollout of one instance for each candidate of a population, until its exit conditions hold.

    Attributes:
        after: final state of the instance's tokens, shape ``(n, m)``; the initial state if the rollout failed.
        steps: number of control periods, shape ``(n,)``.
        exits: final margins of its exit conditions, each in its own unit, shape ``(n, e)``.
        figures: figures of its performance measures, shape ``(n, p)``.
        finite: whether everything that was computed is finite, shape ``(n,)``.
    """

    after: FloatArray
    steps: IntArray
    exits: FloatArray
    figures: FloatArray
    finite: BoolArray

    def rows(self, index: IntArray) -> "Stretch":
        """Return the candidates with these indices."""
        return Stretch(*(getattr(self, field.name)[index] for field in fields(self)))


class Population:
    """The candidates of one rollout: their states, and the results of those that have ended.

    Attributes:
        pending: whether each candidate is still running, shape ``(n,)``.
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
        self.figures = np.array([[-np.inf if m.peak else 0.0 for m in self.measures]] * count).reshape(count, -1)
        self.done = 0  # control steps so far
        self._restrict(np.arange(count))

    def _restrict(self, rows: IntArray) -> None:
        """Continue with these candidates only."""
        self.rows = rows
        mine = {name: value[rows] for name, value in self.chosen.items()}
        self.running = self.model.start_from(self.start[rows], mine)
        self.state = self.model.state(self.after[rows])

    def advance(self) -> None:
        """Take a chunk of steps, check all its states, and retire the candidates that have ended."""
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
        run = self.model.state(chunk)
        margins = self.model.exits(run)  # (t, n, e)
        elapsed = (self.done + 1 + np.arange(count)) * CONTROL_PERIOD
        reached = (margins >= 0).all(axis=-1) & (elapsed >= self.model.shortest)[:, None]
        self.done += count
        ends = self.done >= self.model.longest
        still = (np.abs(chunk[-1] - values[0]).max(axis=-1) < STILL) & (self.done * CONTROL_PERIOD > _AWAKE)
        if still.any():
            still &= _steady(commanded)
        last = np.where(reached.any(axis=0), reached.argmax(axis=0), count - 1)
        over = np.asarray(reached.any(axis=0) | ~finite | still | ends)
        self._measure(run, commanded, np.arange(count)[:, None] <= last)
        retired = over & self.pending[self.rows]
        index, local = self.rows[retired], np.flatnonzero(retired)
        self.after[index] = np.where(finite[local, None], chunk[last[local], local], self.start[index])
        self.exits[index] = margins[last[local], local]
        self.steps[index] = self.done - count + 1 + last[local]
        self.finite[index] = finite[local]
        self.pending[index] = False
        self._drop_retired(chunk[-1])

    def _drop_retired(self, values: FloatArray) -> None:
        """Drop the candidates that have ended once they are half of those in the batch."""
        left = self.pending[self.rows]
        self.after[self.rows[left]] = values[left]
        if left.any() and 2 * np.count_nonzero(left) <= len(left):
            self._restrict(self.rows[left])

    def _measure(self, run: State, commanded: list[Commands], counted: BoolArray) -> None:
        """Add the contribution of the counted states of a chunk ``(t, n)`` to peaks and integrals."""
        counted = counted & self.pending[self.rows]
        binding = self.model.binding
        for column, measure in enumerate(self.measures):
            mine = self.figures[self.rows, column]
            if measure.peak is not None:
                figure = np.where(counted, measure.peak(binding, run), -np.inf).max(axis=0)
                self.figures[self.rows, column] = np.maximum(mine, figure)
            elif measure.rate is not None:
                commands = {key: np.stack([each[key] for each in commanded]) for key in commanded[0]}
                rate = np.where(counted, measure.rate(binding, run, commands), 0.0)
                self.figures[self.rows, column] = mine + rate.sum(axis=0) * CONTROL_PERIOD

    def stretch(self) -> Stretch:
        """Return the results of all candidates."""
        before, after = self.model.state(self.start), self.model.state(self.after)
        for column, measure in enumerate(self.measures):
            if measure.end is not None:
                self.figures[:, column] = measure.end(self.model.binding, before, after, self.chosen)
        finite = self.finite & np.isfinite(self.figures).all(axis=1) & np.isfinite(self.exits).all(axis=1)
        return Stretch(self.after, self.steps, self.exits, self.figures, finite)


def _steady(commanded: Sequence[Commands]) -> BoolArray:
    """Say for which candidates the commands of a chunk are constant; otherwise a policy is about to act."""
    changes = [np.abs(commanded[-1][key] - first).max(axis=-1) for key, first in commanded[0].items()]
    return np.asarray(np.logical_and.reduce([change < _STEADY for change in changes], initial=True), dtype=bool)
