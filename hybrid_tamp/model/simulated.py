"""Blocks whose continuous system is a physics simulator.

A domain declares ``system=PHYSICS``. A stage that opens physics backends passes a backend by `pass_simulator`, because
the model does not know any simulator. The simulator builds a scene of the instance's tokens and all fixed bodies, and
simulates each state of a batch on its own.

A step of a simulator is exact only within one simulation, because contacts have a memory. So a simulation continues as
long as each state is the result of the previous step, and starts again in any other state. The results depend only on
the sequence of the calls, so equal rollouts have equal bits.
"""

import weakref
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import isclose
from typing import Protocol

import numpy as np

from hybrid_tamp.errors import DomainError, Issue
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Commands, ContinuousSystem, SystemMaker
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Binding, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray

_MOST = 128
"""Largest number of open simulations of an instance. More states share simulations, which then start in every step."""


def _not_simulated(binding: Binding, start: State) -> ContinuousSystem:
    """Raise a `DomainError`, because a verb such as `hybrid_tamp.plan` must pass a simulator before the first step."""
    wanted, remedy = "a block with system=PHYSICS requires a simulator", "use a verb such as hybrid_tamp.plan"
    raise DomainError([Issue("system", wanted, remedy=remedy)])


PHYSICS: SystemMaker = _not_simulated
"""Continuous system of a block that a physics simulator moves."""


class Simulator(Protocol):
    """The methods of a physics backend that a simulated block uses."""

    def reset(self, task: Task, state: State) -> State:
        """Build the scene of a task in a state ``(n,)``."""
        ...

    def assign(self, running: Sequence[BlockInstance]) -> None:
        """Set the running instances."""
        ...

    def step(self, commands: Commands) -> State:
        """Apply commands for one control period, and return the state ``(n,)``."""
        ...

    def close(self) -> None:
        """Release the resources."""
        ...


def pass_simulator(task: Task, open_simulator: Callable[[], Simulator]) -> Task:
    """Return the task with simulators in all blocks with ``system=PHYSICS``."""
    wanted = [block for block in task.domain.blocks if block.system is PHYSICS]
    blocks = [replace(block, system=_Simulated(task, block.name, open_simulator)) for block in wanted]
    return task.replaced(domain=task.domain.with_blocks(blocks)) if blocks else task


def is_simulated(block: Block) -> bool:
    """Return whether a simulator moves the tokens of a block."""
    return block.system is PHYSICS or isinstance(block.system, _Simulated)


@dataclass(frozen=True, eq=False)
class _Simulated:
    """The maker of the system of a simulated block."""

    task: Task
    block: str
    open_simulator: Callable[[], Simulator]

    def __call__(self, binding: Binding, start: State) -> ContinuousSystem:
        block = self.task.domain.block_by_name[self.block]
        bound = {value.name: value for value in binding.values() if isinstance(value, Token)}
        fixed = [token for token in self.task.tokens if token.fixed_body and token.name not in bound]
        tokens = (*fixed, *bound.values())
        given = {
            (token.name, each.name): self.task.state[token, each.name] for token in fixed for each in token.varying
        }
        state = State.of(tokens, given)
        scene = self.task.replaced(tokens=tokens, state=state, goal=(), agents={}, assignment={})
        slots = {slot.name: name_of(binding[slot.name]) for slot in block.slots}
        instance = BlockInstance(f"{block.name}-1", block.name, slots, 0.0, 0.0)
        return _Simulation(scene, instance, self.open_simulator)


class _Simulation:
    """The simulations of one instance, one for each state of a batch."""

    def __init__(self, scene: Task, instance: BlockInstance, open_simulator: Callable[[], Simulator]) -> None:
        self._scene, self._instance, self._open = scene, instance, open_simulator
        self._runs: dict[int, _Run] = {}
        weakref.finalize(self, _close, self._runs)

    def __call__(self, state: State, commands: Commands, dt: float) -> State:
        if not isclose(dt, CONTROL_PERIOD):
            came = f"{dt:g} s"
            raise DomainError([Issue("system", f"PHYSICS simulates steps of {CONTROL_PERIOD:.6f} s only", came)])
        batch = state.values.shape[:-1]
        rows = state.values.reshape(-1, state.values.shape[-1])
        flat = {
            key: np.broadcast_to(each, (*batch, each.shape[-1])).reshape(len(rows), -1)
            for key, each in commands.items()
        }
        after = np.empty_like(rows)
        for index, row in enumerate(rows):
            place = index % _MOST
            if place not in self._runs:
                self._runs[place] = _Run(self._scene, self._instance, self._open())
            mine = {key: np.array(each[index]) for key, each in flat.items()}
            after[index] = self._runs[place].step(State(state.layout, row), mine)
        return State(state.layout, after.reshape(state.values.shape))


class _Run:
    """One simulation. `simulator` is open until `close`."""

    def __init__(self, scene: Task, instance: BlockInstance, simulator: Simulator) -> None:
        self.simulator = simulator
        self._scene, self._instance = scene, instance
        self._moved = frozenset(instance.slots.values())
        self._asked: tuple[bytes, ...] = ()
        self._told: FloatArray = np.zeros(0)

    def step(self, state: State, commands: Commands) -> FloatArray:
        """Return the values ``(m,)`` after one control period in a state ``(m,)``."""
        asked = (state.values.tobytes(), *(each.tobytes() for each in commands.values()))
        if asked == self._asked or not np.isfinite(state.values).all():
            return self._told if asked == self._asked else state.values
        if not np.array_equal(state.values, self._told):
            values = {(token, name): state[token, name] for token, name, _ in state.layout.entries}
            self.simulator.reset(self._scene, self._scene.state.replace(values))
            self.simulator.assign([self._instance])
        measured = self.simulator.step(commands)
        moved = {(t, name): measured[t, name] for t, name, _ in state.layout.entries if t in self._moved}
        self._asked, self._told = asked, state.replace(moved).values
        return self._told


def _close(runs: dict[int, _Run]) -> None:
    for run in runs.values():
        run.simulator.close()
