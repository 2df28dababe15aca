"""What blocks miss in physics: contacts that are not allowed, exit conditions, durations and final positions."""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.block import FLOOR, Block
from hybrid_tamp.model.predicate import Binding, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.physics.protocol import Pair
from hybrid_tamp.testing.disagreement import Disagreements, first_role, with_unit
from hybrid_tamp.testing.rollouts import Rollouts

_DELAY = 1.0
"""Difference between two durations that is always tolerated [s]."""
_DISTANCE, _SHARE = 0.05, 0.25
"""Largest distance between the final positions [m], and largest share of the movement. The larger of both counts."""


_FALLING = 0.7
"""Downward speed above which a body falls freely [m/s]."""


@dataclass(frozen=True)
class _Miss:
    """A mistake that a run in physics shows, unless another run of the block shows none."""

    kind: str
    block: Block
    binding: Binding
    declared: str
    measured: str
    role: str


class Misses:
    """The first miss of each block, and the blocks that agreed with their forward models in a run.

    Attributes:
        agreed: names of the blocks that agreed.
    """

    def __init__(self, task: Task, dt: float) -> None:
        self._task, self._dt = task, dt
        self.agreed: set[str] = set()
        self._missed: dict[str, _Miss] = {}

    def report(self, found: Disagreements) -> None:
        """Add the contacts and the misses of the blocks that never agreed with their forward models."""
        for name, miss in self._missed.items():
            if name not in self.agreed:
                found.add(miss.kind, miss.block, miss.binding, miss.declared, miss.measured, miss.role)

    def note_contact(self, block: Block, binding: Binding, pair: Pair, force: float, elapsed: float) -> None:
        """Note a contact force [N] between two bodies of a block, or with the floor, at a time [s] of a run."""
        roles = {name_of(value): role for role, value in binding.items()} | {FLOOR: "FLOOR"}
        if not all(name in roles for name in pair):
            return  # Which bodies stand in the way depends on the task, and collisions with them are not checked.
        one, other = sorted(pair, key=list(roles).index)
        named = f"{roles[one]} and {roles[other]}"
        limit = self._task.limits.contact
        measured = (
            f"{one} and {'the floor' if other == FLOOR else other} touch with {force:.1f} N after {elapsed:.3f} s in "
            f"physics; only short contacts of up to {limit:g} N are tolerated"
        )
        miss = _Miss("contact", block, binding, f"{named} do not touch", measured, roles[one])
        self._missed.setdefault(block.name, miss)

    def note(self, rolled: Rollouts, declared: str, measured: str, role: str) -> None:
        """Note that a run in physics differs from the forward model."""
        self._missed.setdefault(
            rolled.block.name, _Miss("model", rolled.block, rolled.binding, declared, measured, role)
        )

    def note_exit(self, rolled: Rollouts, state: State, elapsed: float) -> None:
        """Note the exit condition with the largest shortfall at the end of a run in physics."""
        margins = {each: float(each.margin(state, rolled.binding)) for each in rolled.block.measured_exits}
        literal = min(margins, key=lambda each: margins[each] / each.predicate.scale)
        measured = (
            f"the forward model reaches the condition after {rolled.lengths[0] * self._dt:.3g} s, and in physics the "
            f"margin is {with_unit(margins[literal], literal.predicate)} after {elapsed:.3g} s"
        )
        self.note(rolled, literal.text, measured, first_role(rolled.block, literal.arguments))

    def compare(self, rolled: Rollouts, state: State, elapsed: float | None) -> None:
        """Compare the duration and the final positions in physics and in the forward model."""
        block, predicted, agreed = rolled.block, rolled.end(0), True
        expected = float(rolled.lengths[0]) * self._dt
        if elapsed is not None and abs(elapsed - expected) > _DELAY and not 0.5 < elapsed / expected < 2.0:
            agreed = False
            measured = f"in physics the block takes {elapsed:.3g} s, and in the forward model {expected:.3g} s"
            self.note(rolled, "the duration of the forward model", measured, block.anchor)
        for slot in block.slots:
            token = rolled.binding[slot.name]
            if not isinstance(token, Token) or "position" not in block.writes.get(slot.name, ()):
                continue
            if _falls(rolled, token):
                continue  # Where a body comes to rest after a fall is chance. Its exit conditions are compared anyway.
            moved = float(np.linalg.norm(predicted[token, "position"] - rolled.start[token, "position"]))
            apart = float(np.linalg.norm(predicted[token, "position"] - state[token, "position"]))
            limit = max(_DISTANCE, _SHARE * moved)
            if apart > limit:
                agreed = False
                measured = (
                    f"in physics {token.name} ends {apart:.3g} m away from its position in the forward model, after a "
                    f"movement of {moved:.3g} m; {limit:.3g} m is tolerated"
                )
                self.note(rolled, f"the forward model of {slot.name}", measured, slot.name)
        if agreed:
            self.agreed.add(block.name)


def _falls(rolled: Rollouts, token: Token) -> bool:
    """Return whether a token falls freely in the rollout with the initial values of the hyperparameters."""
    velocity = rolled.states[token, "velocity"][: rolled.lengths[0] + 1, 0, 2]
    return bool(velocity.min() < -_FALLING)
