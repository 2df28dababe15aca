"""The analytic backend: the blocks' own continuous systems. It needs no simulator and has no contacts."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.commands import CommandLayout
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands, ContinuousSystem
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import ContactForce, Resource

IntArray = NDArray[np.intp]
_Moving = tuple[ContinuousSystem, IntArray]
"""The system of an instance, and the indices of the state of the tokens in its slots."""


class AnalyticBackend(Resource):
    """Moves the tokens of each running instance by its block's continuous system, all at once."""

    name = "analytic"
    timestep = CONTROL_PERIOD

    def __init__(self) -> None:
        self._moving: Mapping[str, _Moving] = {}

    def reset(self, task: Task, state: State) -> State:
        """Start in the given state."""
        self._task = task
        self._commands = CommandLayout.of(task)
        self._state = State(state.layout, np.array(state.values, dtype=float))
        self._moving = {}
        return self._state

    def assign(self, running: Sequence[BlockInstance]) -> None:
        """Run the systems of these instances from now on; each is made when its instance begins."""
        self._moving = {each.name: self._moving.get(each.name) or self._begin(each) for each in running}

    def step(self, commands: Commands) -> State:
        """Take one step of every system, all from the same state.

        Raises:
            CommandError: a command is unknown, of a wrong size, not finite or above its limit.
        """
        filled = self._commands.commands(self._commands.checked(commands))
        before = self._state
        values = before.values.copy()
        for system, mine in self._moving.values():
            after = system(before, filled, self.timestep)
            # A system determines only the state of the tokens in its slots, whatever else it returns.
            values[mine] = after.values[mine]
        self._state = State(before.layout, values)
        return self._state

    def contact_forces(self) -> list[ContactForce]:
        """Return nothing: continuous systems do not report contacts."""
        return []

    @contextmanager
    def snapshot(self) -> Iterator[Callable[[], None]]:
        """Save the state and the systems; states are immutable."""
        state, moving = self._state, self._moving

        def go_back() -> None:
            self._state, self._moving = state, moving

        yield go_back

    def close(self) -> None:
        """Do nothing: there are no resources to free."""

    def _begin(self, instance: BlockInstance) -> _Moving:
        held = set(instance.slots.values())
        mine = [
            index
            for (token, _), columns in self._state.layout.slices.items()
            if token in held
            for index in range(columns.start, columns.stop)
        ]
        block = self._task.domain.block_by_name[instance.block]
        return block.system(self._task.bind(instance.roles), self._state), np.array(mine, dtype=np.intp)
