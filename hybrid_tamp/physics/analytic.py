"""The analytic backend: the blocks' own continuous systems. It needs no simulator and knows no contacts."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import TracebackType

import numpy as np

from hybrid_tamp.model.block import CONTROL_PERIOD, Block, Commands
from hybrid_tamp.model.commands import CommandLayout
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Value
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.physics.protocol import ContactForce

_Part = tuple[Block, Mapping[str, Value], FloatArray]


class AnalyticBackend:
    """Moves the tokens of each running instance by its block's continuous system, side by side."""

    name = "analytic"
    timestep = CONTROL_PERIOD

    def __init__(self) -> None:
        self._parts: tuple[_Part, ...] = ()

    def reset(self, task: Task, state: State) -> State:
        """Start in the state as it is."""
        self._task = task
        self._commands = CommandLayout.of(task)
        self._state = State(state.layout, np.array(state.values, dtype=float))
        self._parts = ()
        return self._state

    def assign(self, running: Sequence[BlockInstance]) -> None:
        """Run the systems of these instances from now on."""
        self._parts = tuple(map(self._part, running))

    def step(self, commands: Commands) -> State:
        """Take one step of every system, all from the same state.

        Raises:
            CommandError: a command is unknown, of a wrong size, not finite or above its limit.
        """
        filled = self._commands.commands(self._commands.checked(commands))
        before = self._state
        values = before.values.copy()
        for block, binding, mine in self._parts:
            after = block.system(binding, before, filled, self.timestep)
            # A system speaks for the tokens in its slots only, whatever else it returns.
            values[mine] = after.values[mine]
        self._state = State(before.layout, values)
        return self._state

    def contact_forces(self) -> list[ContactForce]:
        """Return nothing: continuous systems have contacts inside them and do not tell."""
        return []

    @contextmanager
    def snapshot(self) -> Iterator[Callable[[], None]]:
        """Remember state and systems; states are never changed."""
        state, parts = self._state, self._parts

        def go_back() -> None:
            self._state, self._parts = state, parts

        yield go_back

    def close(self) -> None:
        """Do nothing: there is nothing to free."""

    def __enter__(self) -> "AnalyticBackend":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _part(self, instance: BlockInstance) -> _Part:
        held = set(instance.slots.values())
        mine = [
            index
            for (token, _), part in self._state.layout.slices.items()
            if token in held
            for index in range(part.start, part.stop)
        ]
        block = self._task.domain.block_by_name[instance.block]
        return block, self._task.bind(instance.roles), np.array(mine, dtype=np.intp)
