"""Model of one block instance: its conditions, its hyperparameters and its forward model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import floor

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Parameters
from hybrid_tamp.model.facts import fact_margin
from hybrid_tamp.model.forward_model import BoolArray, ForwardModel
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Atom, Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.model.view import View
from hybrid_tamp.motion.arrays import FloatArray

IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Guard:
    """Conditions on the poses of an instance that also depend on tokens outside of the instance.

    Attributes:
        literals: conditions over the slots of the instance and the keys of `others`. They are evaluated at some poses.
        others: maps keys, which are no names of roles, to tokens that are at rest while the instance runs.
    """

    literals: tuple[Literal, ...] = ()
    others: Mapping[str, Token] = field(default_factory=dict)


class InstanceModel:
    """Model of one block instance of a plan.

    Attributes:
        instance: the block instance.
        block: block of the instance.
        guard: further conditions on the poses of the instance.
        binding: maps each role of the instance to its token or symbol.
        columns: indices of the m values of the tokens of instance and guard in the task's state. Shape ``(m,)``.
        held: mask of the columns that belong to tokens in slots. Tokens that are only targets are excluded.
        longest: maximum number of control steps.
        shortest: minimum duration in seconds.
    """

    def __init__(self, task: Task, instance: BlockInstance, guard: Guard = Guard()) -> None:
        self.instance = instance
        self.guard = guard
        self.block: Block = task.domain.block_by_name[instance.block]
        self.binding = task.bind(instance.roles)
        self._wider = {**self.binding, **guard.others}
        view = View(self._wider, task.state.layout)
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

    def ground(self, literal: Literal) -> Atom:
        """Return the atom of a condition of the instance."""
        return literal.ground(self._wider)

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

    def clearances(self, state: State) -> FloatArray:
        """Return the margins of the guard. Shape ``(..., g)``."""
        return self._margins(self.guard.literals, state)

    @property
    def lasting(self) -> tuple[Literal, ...]:
        """The invariants, followed by the conditions of the guard."""
        return (*self.block.invariants, *self.guard.literals)

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
        return literal.margin(self.state(state.values[:1]) if still else state, self._wider)

    def start_from(self, start: FloatArray, chosen: Mapping[str, FloatArray]) -> ForwardModel:
        """Return the forward model of the instance for initial states of shape ``(n, m)``."""
        return ForwardModel(self.block, self.binding, self.state(start), Parameters.along(self.instance.path, chosen))
