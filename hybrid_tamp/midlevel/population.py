"""Model of one block instance, and rollouts of many candidates as rows of one array.

A candidate reaches its exit, as in a real run, as soon as all exit conditions hold and the minimum duration has passed.
A candidate that reaches no exit ends at the block's maximum duration, or once its state and commands are constant.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from math import floor

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands, Parameters
from hybrid_tamp.model.facts import fact_margin
from hybrid_tamp.model.forward_model import BoolArray, ForwardModel
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.view import View
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.columns import stored_by_column

IntArray = NDArray[np.int64]

CHUNK = 48
"""Number of control steps per chunk. The conditions are checked for all states of a chunk at the same time."""
STILL = 1e-7
"""Largest change of a state within a chunk at which the state is treated as being at rest, in SI units."""
_STEADY = 1e-3
"""Largest change of a command within a chunk at which the command is treated as constant, in SI units."""
_AWAKE = 0.5
"""Time before which no state is treated as being at rest, in seconds, because movements begin slowly."""


class InstanceModel:
    """Model of one block instance of a plan.

    Attributes:
        instance: the block instance.
        block: block of the instance.
        binding: maps each role of the instance to its token or symbol.
        columns: indices of the m values of the instance's tokens in the task's state. Shape ``(m,)``.
        held: mask of the columns that belong to tokens in slots. Tokens that are only targets are excluded.
        longest: maximum number of control steps.
        shortest: minimum duration in seconds.
    """

    def __init__(self, task: Task, instance: BlockInstance) -> None:
        self.instance = instance
        self.block: Block = task.domain.block_by_name[instance.block]
        self.binding = task.bind(instance.roles)
        view = View(self.binding, task.state.layout)
        self.columns = view.columns
        slots = set(instance.slots.values())
        self._layout = view.layout
        self.held = np.array(
            [token in slots for token, _, size in self._layout.entries for _ in range(size)], dtype=bool
        )
        self._initial = view.of(task.state)
        self._moved = {slot.name for slot in self.block.slots if self.block.writes.get(slot.name)}
        self.longest = floor(self.block.duration.maximum / CONTROL_PERIOD + 1e-6)
        self.shortest = self.block.duration.minimum - 1e-6

    def state(self, rows: FloatArray) -> State:
        """Return rows of shape ``(..., m)`` as the state of the instance's tokens."""
        return State(self._layout, rows)

    def exits(self, state: State) -> FloatArray:
        """Return the margins of the measured exit conditions. Shape ``(..., e)``."""
        return self._margins(self.block.measured_exits, state)

    def entries(self, state: State) -> FloatArray:
        """Return the margins of the measured entry conditions. Shape ``(..., e)``."""
        changing = self._margins(self.block.measured_entries, state)
        facts = (fact_margin(each, self._initial, state, self.binding) for each in self.block.posed_entries)
        columns = [np.broadcast_to(each, state.values.shape[:-1])[..., None] for each in facts]
        return np.concatenate([changing, *columns], axis=-1)

    def invariants(self, state: State) -> FloatArray:
        """Return the margins of the invariants. Shape ``(..., i)``."""
        return self._margins(self.block.invariants, state)

    def holding(self, run: State, late: BoolArray) -> BoolArray:
        """Return a mask ``(t, n)`` of the states of a run ``(t, n, m)`` in which all exit conditions hold.

        `late` says in which steps the minimum duration is over. The mask is false in all other steps. Shape ``(t,)``.
        """
        found = np.repeat(late[:, None], run.values.shape[1], axis=1)
        first = int(late.argmax())
        # Conditions with fewer arguments are cheaper. A condition is computed only where all cheaper conditions hold.
        for literal in sorted(self.block.measured_exits, key=lambda literal: len(literal.arguments)):
            if found[first:].all():
                found[first:] = literal.margin(self.state(run.values[first:]), self.binding) >= 0
            elif found.any():
                found[found] = literal.margin(self.state(run.values[found]), self.binding) >= 0
        return found

    def _margins(self, literals: Sequence[Literal], state: State) -> FloatArray:
        batch = state.values.shape[:-1]
        margins = [np.broadcast_to(self._margin(literal, state), batch) for literal in literals]
        return np.stack(margins, axis=-1) if margins else np.zeros((*batch, 0))

    def _margin(self, literal: Literal, state: State) -> FloatArray:
        # If the instance moves no token of a condition, its margin is the same in all steps of a run ``(t, n, m)``.
        still = state.values.ndim == 3 and self._moved.isdisjoint(literal.arguments)
        return literal.margin(self.state(state.values[:1]) if still else state, self.binding)

    def start_from(self, start: FloatArray, chosen: Mapping[str, FloatArray]) -> ForwardModel:
        """Return the forward model of the instance for initial states of shape ``(n, m)``."""
        return ForwardModel(self.block, self.binding, self.state(start), Parameters.along(self.instance.path, chosen))


@dataclass(frozen=True, eq=False)
class Stretch:
    """Rollouts of one instance until its exit conditions hold, for n candidates.

    Attributes:
        after: final state of the instance's tokens, or the initial state if the rollout failed. Shape ``(n, m)``.
        steps: number of control periods. Shape ``(n,)``.
        exits: final margins of the exit conditions, each in the unit of its predicate. Shape ``(n, e)``.
        invariants: least margins of the invariants, each in its own unit. Shape ``(n, i)``.
        figures: values of the performance measures. Shape ``(n, p)``.
        finite: whether all computed values are finite. Shape ``(n,)``.
    """

    after: FloatArray
    steps: IntArray
    exits: FloatArray
    invariants: FloatArray
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
        self.invariants = np.full((count, len(model.block.invariants)), np.inf)
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
            self.exits[index] = self.model.exits(self.model.state(chunk[last[local], local]))
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
        """Update the least margins of the invariants with those states of a chunk that `counted` selects."""
        counted = counted & self.pending[self.rows]
        least = np.where(counted[..., None], self.model.invariants(run), np.inf).min(axis=0)
        self.invariants[self.rows] = np.minimum(self.invariants[self.rows], least)

    def stretch(self) -> Stretch:
        """Return the results of all candidates."""
        before, after = self.model.state(self.start), self.model.state(self.after)
        for column, measure in enumerate(self.measures):
            if measure.end is not None:
                name, binding = self.model.block.name, self.model.binding
                self.figures[:, column] = measure.at_end(name, binding, before, after, self.chosen)
        finite = self.finite & np.isfinite(self.figures).all(axis=1) & np.isfinite(self.exits).all(axis=1)
        return Stretch(self.after, self.steps, self.exits, self.invariants, self.figures, finite)


def _steady(commanded: Sequence[Commands]) -> BoolArray:
    """Return a mask of the candidates with constant commands in a chunk. Changing commands can cause motion."""
    changes = [np.abs(commanded[-1][key] - first).max(axis=-1) for key, first in commanded[0].items()]
    return np.asarray(np.logical_and.reduce([change < _STEADY for change in changes], initial=True), dtype=bool)
