"""The model of one block instance of a plan: its part of the state, its conditions, its policy and system."""

from collections.abc import Mapping, Sequence
from math import floor

import numpy as np

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Parameters
from hybrid_tamp.model.forward_model import ForwardModel
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray


class InstanceModel:
    """The model of one instance of a plan.

    Attributes:
        instance: the instance.
        block: its block.
        binding: its roles.
        columns: indices of the state of its roles' tokens in a row of the task's state, shape ``(m,)``.
        held: whether each of these columns belongs to a token in a slot, shape ``(m,)``.
        longest: maximum number of control steps.
        shortest: minimum duration [s].
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
        self.longest = floor(self.block.duration.maximum / CONTROL_PERIOD + 1e-6)
        self.shortest = self.block.duration.minimum - 1e-6

    def state(self, rows: FloatArray) -> State:
        """Return rows ``(..., m)`` as the state of the instance's tokens."""
        return State(self._layout, rows)

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

    def start_from(self, start: FloatArray, chosen: Mapping[str, FloatArray]) -> ForwardModel:
        """Make its policy and system for states ``(n, m)`` at its beginning."""
        return ForwardModel(self.block, self.binding, self.state(start), Parameters(chosen))
