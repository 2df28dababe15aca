"""One block instance rolled out for a whole population: its policy and its continuous system, step by step.

The candidates of a population are rows of one array. A candidate has come to its exit at the first control step at
which its minimum duration has passed and all exit conditions hold, as in a real run; else it ends at the block's bound,
or where it has come to rest short of its exit and its commands do, too.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from math import floor

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands
from hybrid_tamp.model.forward_model import BoolArray, ForwardModel
from hybrid_tamp.model.parameters import Parameters
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

IntArray = NDArray[np.int64]

_CHUNK = 48
"""Control steps between two looks at the conditions: one look at many states costs little more than at one."""
_STILL = 1e-7
"""What changes by less than this within a chunk has come to rest [SI units]."""
_STEADY = 1e-3
"""A command that changes by less than this within a chunk does not change [SI units]."""
_AWAKE = 0.5
"""How long nothing is taken to be at rest [s]: movements begin slowly."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """What one instance did to each candidate of a population, until its exit conditions held.

    Attributes:
        after: state of the instance's tokens then, shape ``(n, m)``.
        steps: control periods until then, shape ``(n,)``.
        exits: margins of its exit conditions then, each in its own unit, shape ``(n, e)``.
        figures: figures of its performance measures, shape ``(n, p)``.
        finite: whether all that was computed is finite, shape ``(n,)``; where not, `after` is the state at the start.
    """

    after: FloatArray
    steps: IntArray
    exits: FloatArray
    figures: FloatArray
    finite: BoolArray

    def rows(self, index: IntArray) -> "Stretch":
        """Return some candidates, in the order of the index."""
        return Stretch(*(getattr(self, field.name)[index] for field in fields(self)))


class Simulation:
    """The simulation of one instance of a plan.

    Attributes:
        instance: the instance.
        block: its block.
        binding: its roles.
        columns: where the state of its roles' tokens lies in a row of the task's state, shape ``(m,)``.
        held: which of these columns belong to tokens in its slots, shape ``(m,)``.
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
        self._longest = floor(self.block.duration.maximum / CONTROL_PERIOD + 1e-6)
        self._shortest = self.block.duration.minimum - 1e-6
        self._known: dict[bytes, Stretch] = {}

    def state(self, rows: FloatArray) -> State:
        """Return rows ``(..., m)`` as the state of the instance's tokens."""
        return State(self._layout, rows)

    def run(self, start: FloatArray, chosen: Mapping[str, FloatArray]) -> Stretch:
        """Roll out until the exit conditions hold.

        Candidates that begin alike are computed once, and a beginning that all share is remembered.

        Args:
            start: states of the instance's tokens at its beginning, shape ``(n, m)``.
            chosen: hyperparameter to its values, shape ``(n,)``.
        """
        table = np.column_stack([start, *(chosen[h.name] for h in self.block.hyperparameters)])
        _, first, inverse = np.unique(table, axis=0, return_index=True, return_inverse=True)
        inverse = inverse.reshape(-1)
        if len(first) > 1:
            return self._run(start[first], {name: value[first] for name, value in chosen.items()}).rows(inverse)
        key = table[0].tobytes()
        if key not in self._known:
            self._known[key] = self._run(start[first], {name: value[first] for name, value in chosen.items()})
        return self._known[key].rows(inverse)

    def hold(self, start: FloatArray, chosen: Mapping[str, FloatArray], begun: Stretch, until: IntArray) -> FloatArray:
        """Return the states ``(n, m)`` after the instance has gone on holding until these steps of its own."""
        more: IntArray = until - begun.steps
        if not self.block.moves or not more.max() > 0:
            return begun.after
        model = self._model(start, chosen)
        state: FloatArray = begun.after
        held: FloatArray = state.copy()
        for step in range(int(more.max())):
            elapsed = np.asarray((begun.steps + step) * CONTROL_PERIOD, dtype=np.float64)
            with np.errstate(all="ignore"):
                after = model.step(elapsed, self.state(state))[0].values
            held = np.where((step < more)[:, None], after, held)
            if step % _CHUNK == _CHUNK - 1 and np.abs(after - state).max() < _STILL / _CHUNK:
                break
            state = after
        return held

    def _run(self, start: FloatArray, chosen: Mapping[str, FloatArray]) -> Stretch:
        if not self.block.moves:
            return self._unmoved(start, chosen)
        population = _Population(self, start, chosen)
        with np.errstate(all="ignore"):
            while population.pending.any():
                population.advance()
            return population.stretch()

    def _unmoved(self, start: FloatArray, chosen: Mapping[str, FloatArray]) -> Stretch:
        """Return what an instance does whose system changes nothing: it ends as soon as it may."""
        least = int(np.ceil(self._shortest / CONTROL_PERIOD - 1e-6))
        exits = self.exits(self.state(start))
        steps = np.where((exits >= 0).all(axis=1), least, self._longest)
        figures = np.zeros((len(start), len(self.block.performance)))
        return Stretch(start, steps.astype(np.int64), exits, figures, np.asarray(np.isfinite(exits).all(axis=1)))

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

    def _model(self, start: FloatArray, chosen: Mapping[str, FloatArray]) -> ForwardModel:
        return ForwardModel(self.block, self.binding, self.state(start), Parameters(chosen))


class _Population:
    """The candidates of one rollout: where each is, and what has come of those that are done.

    Attributes:
        pending: which candidates have not come to their end yet, shape ``(n,)``.
    """

    def __init__(self, simulation: Simulation, start: FloatArray, chosen: Mapping[str, FloatArray]) -> None:
        self.simulation = simulation
        self.measures = simulation.block.performance
        self.start, self.chosen = start, chosen
        count = len(start)
        self.pending = np.ones(count, dtype=bool)
        self.after = start.copy()
        self.steps = np.zeros(count, dtype=np.int64)
        self.finite = np.ones(count, dtype=bool)
        self.exits = np.full((count, len(simulation.block.measured_exits)), np.nan)
        self.figures = np.array([[-np.inf if m.peak else 0.0 for m in self.measures]] * count).reshape(count, -1)
        self.done = 0  # control steps so far
        self._restrict(np.arange(count))

    def _restrict(self, rows: IntArray) -> None:
        """Go on with these candidates only."""
        self.rows = rows
        mine = {name: value[rows] for name, value in self.chosen.items()}
        self.model = self.simulation._model(self.start[rows], mine)
        self.state = self.simulation.state(self.after[rows])

    def advance(self) -> None:
        """Take a chunk of steps, look at every state of it, and retire the candidates that have come to an end."""
        count = min(_CHUNK, self.simulation._longest - self.done)
        values, commanded = [self.state.values], []
        finite = np.ones(len(self.rows), dtype=bool)
        for step in range(self.done, self.done + count):
            elapsed = np.float64(step * CONTROL_PERIOD)
            self.state, commands, sound = self.model.step(elapsed, self.state)
            finite &= sound
            values.append(self.state.values)
            commanded.append(commands)
        chunk = np.stack(values[1:])  # (t, n, m)
        run = self.simulation.state(chunk)
        margins = self.simulation.exits(run)  # (t, n, e)
        elapsed = (self.done + 1 + np.arange(count)) * CONTROL_PERIOD
        reached = (margins >= 0).all(axis=-1) & (elapsed >= self.simulation._shortest)[:, None]
        self.done += count
        ends = self.done >= self.simulation._longest
        still = (np.abs(chunk[-1] - values[0]).max(axis=-1) < _STILL) & (self.done * CONTROL_PERIOD > _AWAKE)
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
        self._go_on(chunk[-1])

    def _go_on(self, values: FloatArray) -> None:
        """Drop candidates that are done once they are the most."""
        left = self.pending[self.rows]
        self.after[self.rows[left]] = values[left]
        if left.any() and 2 * np.count_nonzero(left) <= len(left):
            self._restrict(self.rows[left])

    def _measure(self, run: State, commanded: list[Commands], counted: BoolArray) -> None:
        """Add what the chunk ``(t, n)`` contributes to peaks and integrals, of the states that count."""
        counted = counted & self.pending[self.rows]
        binding = self.simulation.binding
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
        """Return what came of all candidates."""
        before, after = self.simulation.state(self.start), self.simulation.state(self.after)
        for column, measure in enumerate(self.measures):
            if measure.end is not None:
                self.figures[:, column] = measure.end(self.simulation.binding, before, after, self.chosen)
        finite = self.finite & np.isfinite(self.figures).all(axis=1) & np.isfinite(self.exits).all(axis=1)
        return Stretch(self.after, self.steps, self.exits, self.figures, finite)


def _steady(commanded: Sequence[Commands]) -> BoolArray:
    """Return for which candidates a chunk's commands do not change; else a policy is about to do something."""
    changes = [np.abs(commanded[-1][key] - first).max(axis=-1) for key, first in commanded[0].items()]
    return np.asarray(np.logical_and.reduce([change < _STEADY for change in changes], initial=True), dtype=bool)
