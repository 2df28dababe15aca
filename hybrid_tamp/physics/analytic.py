"""The analytic backend, which simulates the blocks' continuous systems without a contact model."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.commands import CommandLayout
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands, ContinuousSystem
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.view import View
from hybrid_tamp.physics.protocol import ContactForce, Resource

IntArray = NDArray[np.intp]


class _Moving(NamedTuple):
    """The continuous system of an instance, with the part of the state and of the commands that the system sees.

    `tokens` are the tokens in slots. `mine` are the indices of their values in the state.
    """

    name: str
    binding: Binding
    system: ContinuousSystem
    view: View
    tokens: frozenset[str]
    mine: IntArray


class AnalyticBackend(Resource):
    """A backend that moves the tokens of each running instance by the continuous system of the instance's block."""

    name = "analytic"
    timestep = CONTROL_PERIOD

    def __init__(self) -> None:
        self._moving: Mapping[str, _Moving] = {}

    def reset(self, task: Task, state: State) -> State:
        """Set the state, of shape ``(n,)``, and return a copy."""
        self._task = task
        self._commands = CommandLayout.of(task)
        self._state = State(state.layout, np.array(state.values, dtype=float))
        self._moving = {}
        return self._state

    def assign(self, running: Sequence[BlockInstance]) -> None:
        """Set the running instances. The system of an instance is made when the instance begins."""
        self._moving = {each.name: self._moving.get(each.name) or self._begin(each) for each in running}

    def step(self, commands: Commands) -> State:
        """Advance every system by one step. All systems start from the same state.

        Raises:
            CommandError: a command is unknown, not finite, above its limit, or has the wrong size.
        """
        filled = self._commands.commands(self._commands.checked(commands))
        before = self._state
        values = before.values.copy()
        for name, binding, system, view, tokens, mine in self._moving.values():
            commands = {key: command for key, command in filled.items() if key[0] in tokens}
            with authored(name, binding):
                after = system(view.of(before), commands, self.timestep)
            # Only the values of tokens in the slots are used, even if the system changes other values.
            values[mine] = view.update(before, after).values[mine]
        self._state = State(before.layout, values)
        return self._state

    def contact_forces(self) -> list[ContactForce]:
        """Return an empty list, because continuous systems do not report contacts."""
        return []

    @contextmanager
    def snapshot(self) -> Iterator[Callable[[], None]]:
        """Save the current state and systems. The context provides a function that restores the saved values."""
        state, moving = self._state, self._moving

        def go_back() -> None:
            self._state, self._moving = state, moving

        yield go_back

    def close(self) -> None:
        """Do nothing, because this backend has no resources to release."""

    def _begin(self, instance: BlockInstance) -> _Moving:
        held = frozenset(instance.slots.values())
        mine = [
            index
            for (token, _), columns in self._state.layout.slices.items()
            if token in held
            for index in range(columns.start, columns.stop)
        ]
        block = self._task.domain.block_by_name[instance.block]
        binding = self._task.bind(instance.roles)
        name, view = f"{block.name}.system", View(binding, self._state.layout)
        with authored(name, binding):
            system = block.system_maker(binding, view.of(self._state))
        return _Moving(name, binding, system, view, held, np.array(mine, dtype=np.intp))
