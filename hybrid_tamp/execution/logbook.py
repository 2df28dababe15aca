"""Log of a run. `Logbook.make_recording` turns the log into a recording."""

import logging
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from hybrid_tamp.execution.running_instance import Running
from hybrid_tamp.model.commands import CommandLayout, Key
from hybrid_tamp.model.contacts import Contact, ContactRules
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.recording import AtomMargin, Failure, Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.physics.protocol import Backend, ContactForce

NOTEWORTHY = 0.1
"""A warning is logged if a command is limited in at least this share of an instance's control steps."""

_logger = logging.getLogger(__name__)


class Period(NamedTuple):
    """One control period.

    Attributes:
        state: state at the end of the period, shape ``(n,)``.
        row: limited commands, shape ``(m,)``.
        cut: pair of (token, action) for each command that was limited.
        contacts: contact forces during the period.
    """

    state: State
    row: FloatArray
    cut: tuple[Key, ...]
    contacts: Sequence[ContactForce]


class Logbook:
    """Log of states, commands, contacts and ended instances.

    Attributes:
        last_event: time of the last reassignment [s].
    """

    def __init__(self, task: Task, layout: CommandLayout, backend: Backend) -> None:
        self.last_event = 0.0
        self._task = task
        self._layout = layout
        self._backend = backend
        self._states: list[FloatArray] = []
        self._commands: list[FloatArray] = []
        self._instances: list[BlockInstance] = []
        self._exits: dict[str, tuple[AtomMargin, ...]] = {}
        self._cuts: Counter[tuple[str, Key]] = Counter()
        self._contacts: dict[tuple[tuple[str, str], tuple[str, str]], Contact] = {}

    def copy(self) -> "Logbook":
        """Return an independent copy with the entries so far."""
        other = copy(self)
        for name in ("_states", "_commands", "_instances", "_exits", "_cuts", "_contacts"):
            setattr(other, name, copy(getattr(self, name)))
        return other

    @property
    def started(self) -> bool:
        """Whether the initial state is recorded."""
        return bool(self._states)

    def has_ended(self, instance: str) -> bool:
        """Return whether the end of an instance is recorded."""
        return instance in self._exits

    @property
    def steps(self) -> int:
        """Number of control periods recorded so far."""
        return len(self._commands)

    @property
    def time(self) -> float:
        """Simulated time [s]. The time is computed as a product, so rounding errors do not accumulate."""
        return self.steps * self._backend.timestep

    @property
    def last_state(self) -> State:
        """The last recorded state, shape ``(n,)``."""
        return State(self._task.state.layout, self._states[-1])

    @property
    def step_index(self) -> int:
        """Index of the current step: one plus the number of distinct times at which instances have ended."""
        return 1 + len({instance.end for instance in self._instances})

    def start(self, state: State) -> None:
        """Record the initial state, shape ``(n,)``."""
        self._states.append(state.values)

    def record_step(self, period: Period, within: Mapping[str, str], rules: ContactRules) -> Contact | None:
        """Record one control period, with the largest contact force of each pair of tokens in each pair of instances.

        Args:
            period: the control period.
            within: maps each token to the name of its instance during the control period.
            rules: the contacts that these instances allow.

        Returns:
            The contact of the control period that is not allowed and has the largest force; None if there is none.
        """
        self._states.append(period.state.values)
        self._commands.append(period.row)
        if period.cut:
            self._cuts.update((within[key[0]], key) for key in period.cut if key[0] in within)
        worst: Contact | None = None
        for one, other, force in period.contacts:
            tokens = (one, other)
            instances = (
                "" if rules.rests_on(other, one) else within.get(one, ""),
                "" if rules.rests_on(one, other) else within.get(other, ""),
            )
            known = self._contacts.get((tokens, instances))
            allowed = rules.allow(one, other, period.state)
            if allowed and known is not None and force <= known.force:
                continue
            contact = Contact(tokens, instances, force, self.time, allowed)
            if known is None or force > known.force:
                self._contacts[tokens, instances] = contact
            if not allowed and (worst is None or force > worst.force):
                worst = contact
        return worst

    def record_end(self, running: Running, time: float, exits: tuple[AtomMargin, ...]) -> None:
        """Record the end of an instance with its actual times, its hyperparameters and its exit margins."""
        done = replace(
            running.instance,
            start=running.begin,
            end=time,
            hyperparameters=dict(running.hyperparameters),
            reached=running.reached if running.block.hold else None,
        )
        self._instances.append(done)
        self._exits[done.name] = exits

    def make_recording(self, goal: tuple[AtomMargin, ...], failure: Failure | None) -> Recording:
        """Return the recording of all entries, with the margins of the goal and the failure, if any."""
        rows = len(self._states)
        return Recording(
            layout=self._task.state.layout,
            commands_layout=self._layout.entries,
            times=np.arange(rows, dtype=np.float64) * self._backend.timestep,
            states=np.array(self._states),
            commands=np.array(self._commands).reshape(rows - 1, self._layout.size),
            instances=tuple(sorted(self._instances, key=lambda i: (i.start, i.end, i.name))),
            exits=dict(self._exits),
            goal=goal,
            backend=self._backend.name,
            timestep=self._backend.timestep,
            failure=failure,
            warnings=tuple(self._warn_of_cuts()),
            contacts=tuple(sorted(self._contacts.values(), key=lambda c: (c.time, c.tokens))),
        )

    def _warn_of_cuts(self) -> Iterable[str]:
        lengths = {i.name: (i.end - i.start) / self._backend.timestep for i in self._instances}
        for (instance, (token, action)), count in sorted(self._cuts.items()):
            if count < NOTEWORTHY * lengths[instance]:
                continue
            said = f"{instance}: the {action} on {token} was limited in {count} control steps"
            _logger.warning("%s", said)
            yield said
