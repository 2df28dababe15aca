"""Runs of single blocks in physics. They show contacts that a block does not allow, and faults of forward models."""

import logging
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import ExitStack

import numpy as np

from hybrid_tamp.errors import DomainError, InputError
from hybrid_tamp.execution.running_instance import RunError, Running, command_instances
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.commands import CommandLayout
from hybrid_tamp.model.contacts import ContactRules
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Binding, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import SIMULATOR, Backend, Pair, open_backend
from hybrid_tamp.testing.disagreement import Disagreements
from hybrid_tamp.testing.misses import Misses
from hybrid_tamp.testing.rollouts import roll_out_rows
from hybrid_tamp.testing.walk import Chooser

_WALKS = 3
_STEPS = 12
"""Largest number of walks, and of blocks in a walk, until each block has run."""
_FACTOR, _PATIENCE = 3.0, 2.0
"""A run lasts at most the factor times the duration in the forward model, plus the patience [s]."""
_SETTLING = 0.25
"""Time for which a block without exit conditions runs [s]."""
_LIGHT, _LONG = 0.5, 24
"""Two bodies touch if the force exceeds the first value [N] for more than this number of control periods."""

_logger = logging.getLogger(__name__)

_Place = tuple[str, str]
"""Pair of (block, slot)."""


def simulate_blocks(task: Task, chooser: Chooser, found: Disagreements, rng: np.random.Generator, dt: float) -> None:
    """Walk through the blocks in physics, from the initial state of a task, until each block has run once.

    A block is reported only if it fails in all its runs. A task that the physics backend cannot simulate is not run.

    Args:
        task: task whose tokens are simulated.
        chooser: finds the blocks that can be entered.
        found: collection to which disagreements are added.
        rng: random generator.
        dt: time step of the rollouts of the forward models [s].
    """
    with ExitStack() as stack:
        try:
            backend = stack.enter_context(open_backend(SIMULATOR))
            backend.reset(task, task.state)
        except DomainError:
            raise
        except InputError as error:
            _logger.warning("the blocks are not run in physics: %s", error)
            return
        physics = _Physics(task, chooser, found, rng, dt, backend)
        for _ in range(_WALKS):
            physics.walk()
        physics.misses.report(found)


class _Physics:
    """Walks in physics, with the findings so far."""

    def __init__(
        self, task: Task, chooser: Chooser, found: Disagreements, rng: np.random.Generator, dt: float, backend: Backend
    ) -> None:
        self._task, self._chooser, self._found, self._rng, self._dt = task, chooser, found, rng, dt
        self._backend, self._layout = backend, CommandLayout.of(task)
        self.misses = Misses(task, dt)

    def walk(self) -> None:
        """Run one block after another, until every block has agreed with its model or no other block can be entered."""
        state = self._backend.reset(self._task, self._task.state)
        places = {t.name: _first_place(self._task.start_block(t.name)) for t in self._task.assigned}
        for _ in range(_STEPS):
            chosen = self._choose(state, places)
            if chosen is None:
                return
            block, binding = chosen
            after = self._run(block, binding, state)
            if after is None:
                return
            state, places = after, self._places(block, binding, places)

    def _choose(self, state: State, places: Mapping[str, _Place]) -> tuple[Block, Binding] | None:
        """Return a block that can be entered lawfully. Blocks that have not agreed with their models are preferred."""
        if all(block.name in self.misses.agreed for block in self._chooser.blocks):
            return None
        every = [
            (choice.block, binding)
            for choice in self._chooser.choices(self._task.state, state)
            for binding in choice.bindings
            if self._is_lawful(choice.block, binding, places)
        ]
        fresh = [pair for pair in every if pair[0].name not in self.misses.agreed]
        moving = [(b, v) for b, v in every if any(float(each.margin(state, v)) < 0 for each in b.measured_exits)]
        options = fresh or moving
        return options[int(self._rng.integers(len(options)))] if options else None

    def _is_lawful(self, block: Block, binding: Binding, places: Mapping[str, _Place]) -> bool:
        """Return whether an edge leads each token to its slot, and all tokens of other blocks to the resting block."""
        network, after = self._task.domain.network, self._places(block, binding, places)
        return all(after[token] == before or network.allows(before, after[token]) for token, before in places.items())

    def _places(self, block: Block, binding: Binding, places: Mapping[str, _Place]) -> dict[str, _Place]:
        """Return the places of the tokens while a block runs and all other tokens rest."""
        resting = _first_place(self._task.domain.block_by_name[self._task.domain.resting])
        held = {name_of(binding[slot.name]): (block.name, slot.name) for slot in block.slots}
        return {token: held.get(token, resting) for token in places}

    def _run(self, block: Block, binding: Binding, start: State) -> State | None:
        """Run a block, and compare the run with the forward model. Return the final state, or None after a failure."""
        values = block.initial_values(binding, start)
        chosen = {name: np.array([value], dtype=float) for name, value in values.items()}
        rolled = roll_out_rows(block, binding, start, chosen, 1, self._dt)
        longest = _FACTOR * int(rolled.lengths[0]) * self._dt + _PATIENCE if block.measured_exits else _SETTLING
        try:
            state, elapsed = self._execute(block, binding, start, longest)
        except RunError as error:
            self.misses.note(rolled, "the policy works in physics", error.reason, block.anchor)
            return None
        if state is None:
            return None
        if elapsed is None and block.measured_exits:
            if rolled.rows:
                self.misses.note_exit(rolled, state, longest)
            return None
        if rolled.rows:
            self.misses.compare(rolled, state, elapsed)
        else:
            self.misses.agreed.add(block.name)  # The forward model is reported already, because no rollout succeeds.
        return state

    def _execute(
        self, block: Block, binding: Binding, state: State, longest: float
    ) -> tuple[State | None, float | None]:
        """Return the state at the end of a run, and the time at which the exit conditions hold [s].

        The state is None after a contact that is not allowed. The time is None if the exit conditions do not hold.
        """
        instances = list(_instances(self._task, block, binding))
        task = self._task
        rules = ContactRules(task.domain.block_by_name, instances, task.fixed_bodies, task.token_by_name)
        self._backend.assign(instances)
        running = [Running(self._task, instance, 0.0, state) for instance in instances]
        touched: Counter[Pair] = Counter()
        period, steps = self._backend.timestep, int(np.ceil(longest / self._backend.timestep))
        for step in range(steps):
            row, _ = self._layout.limited(command_instances(self._layout, running, step * period, state))
            state = self._backend.step(self._layout.commands(row))
            if not np.isfinite(state.values).all():
                raise RunError("", f"the state in physics is not finite after {(step + 1) * period:.3f} s")
            for one, other, force in self._backend.contact_forces():
                allowed = rules.allow(one, other, state)
                touched[one, other] += force > _LIGHT and not allowed
                heavy = force > task.limits.contact and not allowed
                if heavy or touched[one, other] > _LONG:
                    self.misses.note_contact(block, binding, (one, other), force, (step + 1) * period)
                    return None, None
            if block.measured_exits and running[0].is_ready((step + 1) * period, state):
                return state, (step + 1) * period
        return state, None


def _first_place(block: Block) -> _Place:
    return block.name, block.slots[0].name


def _instances(task: Task, block: Block, binding: Binding) -> Iterator[BlockInstance]:
    """Yield the instance of a block, and instances of the resting block for all other tokens."""
    slots = {slot.name: name_of(binding[slot.name]) for slot in block.slots}
    targets = {target.name: name_of(binding[target.name]) for target in block.targets}
    yield BlockInstance(f"{block.name}-1", block.name, slots, 0.0, 0.0, targets)
    name, slot = _first_place(task.domain.block_by_name[task.domain.resting])
    others = (token.name for token in task.assigned if token.name not in slots.values())
    for number, token in enumerate(others, start=2):
        yield BlockInstance(f"{name}-{number}", name, {slot: token}, 0.0, 0.0)
