"""Rollout of one block instance for a whole population, first until the exit and then until the instance ends."""

from collections.abc import Mapping

import numpy as np

from hybrid_tamp.midlevel.instance_model import Guard, InstanceModel, IntArray
from hybrid_tamp.midlevel.population import CHUNK, STILL, Population, Stretch
from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray


class Simulation(InstanceModel):
    """Model of one block instance that computes and caches rollouts."""

    def __init__(
        self,
        task: Task,
        instance: BlockInstance,
        deadline: Deadline = NEVER,
        guard: Guard = Guard(),  # noqa: B008
    ) -> None:
        super().__init__(task, instance, guard)
        self._deadline = deadline
        self._known: dict[bytes, Stretch] = {}
        self._paths: dict[bytes, FloatArray] = {}

    def run(self, start: FloatArray, chosen: Mapping[str, FloatArray]) -> Stretch:
        """Roll out the instance until its exit conditions hold.

        Candidates with equal initial states and hyperparameters are computed once. If all candidates are equal, the
        result is cached.

        Args:
            start: initial states of the instance's tokens. Shape ``(n, m)``.
            chosen: maps each hyperparameter to the values of all candidates. Shape ``(n,)``.
        """
        table = self._table(start, chosen)
        _, first, inverse = np.unique(table, axis=0, return_index=True, return_inverse=True)
        inverse = inverse.reshape(-1)
        if len(first) > 1:
            return self._run(start[first], {name: value[first] for name, value in chosen.items()})[0].rows(inverse)
        key = table[0].tobytes()
        if key not in self._known:
            found = self._run(start[first], {name: value[first] for name, value in chosen.items()})
            self._known[key], self._paths[key] = found
        return self._known[key].rows(inverse)

    def hold(self, start: FloatArray, chosen: Mapping[str, FloatArray], begun: Stretch, until: IntArray) -> FloatArray:
        """Continue the instance after its exit, and return the final states of its tokens. Shape ``(n, m)``.

        ``begun`` is the rollout until the exit. ``until`` is the number of control steps from the start of the instance
        to its end. Shape ``(n,)``.
        """
        more: IntArray = until - begun.steps
        if not self.block.moves or not more.max() > 0:
            return begun.after
        model = self.start_from(start, chosen)
        state: FloatArray = begun.after
        held: FloatArray = state.copy()
        for step in range(int(more.max())):
            elapsed = np.asarray((begun.steps + step) * CONTROL_PERIOD, dtype=np.float64)
            with np.errstate(all="ignore"):
                after = model.step(elapsed, self.state(state))[0].values
            held = np.where((step < more)[:, None], after, held)
            if step % CHUNK == CHUNK - 1:
                self._deadline.check()
            if step % CHUNK == CHUNK - 1 and np.abs(after - state).max() < STILL / CHUNK:
                break
            state = after
        return held

    def trace(self, start: FloatArray, chosen: Mapping[str, FloatArray]) -> State:
        """Return the states ``(t + 1, m)`` from the start to the exit in an earlier `run` of a single candidate.

        `start` has shape ``(1, m)``, and the values in `chosen` have shape ``(1,)``.
        """
        key = self._table(start, chosen)[0].tobytes()
        return self.state(self._paths[key][: int(self._known[key].steps[0]) + 1])

    def _table(self, start: FloatArray, chosen: Mapping[str, FloatArray]) -> FloatArray:
        return np.column_stack([start, *(chosen[h.name] for h in self.block.hyperparameters)])

    def _run(self, start: FloatArray, chosen: Mapping[str, FloatArray]) -> tuple[Stretch, FloatArray]:
        """Return the rollouts of all candidates, and the states of a single candidate, shape ``(t, m)``."""
        if not self.block.moves:
            return self._stay(start), start
        population = Population(self, start, chosen)
        with np.errstate(all="ignore"):
            while population.pending.any():
                self._deadline.check()
                population.advance()
            return population.stretch(), np.concatenate(population.path)

    def _stay(self, start: FloatArray) -> Stretch:
        """Return the rollout of a block that moves no tokens.

        The rollout takes the minimum duration if the exit conditions hold, else the maximum duration.
        """
        least = int(np.ceil(self.shortest / CONTROL_PERIOD - 1e-6))
        exits, invariants = self.exits(self.state(start)), self.invariants(self.state(start))
        steps = np.where((exits >= 0).all(axis=1), least, self.longest)
        figures = np.zeros((len(start), len(self.block.performance)))
        finite = np.asarray(np.isfinite(exits).all(axis=1))
        return Stretch(start, steps.astype(np.int64), exits, invariants, figures, finite)
