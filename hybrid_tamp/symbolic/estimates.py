"""How long the instances of a plan are going to last, from the states in which they are expected to begin."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decoder import OrderedInstance

TICK = 1e-3
"""Times are whole ticks [s]: sums of floats would turn a cycle of length zero into an endless one."""

Moves = Mapping[str, str]
"""Thing to the place where it has been brought."""


@dataclass(frozen=True)
class Estimate:
    """What is expected of one instance.

    Attributes:
        seconds: how long it lasts, or takes to its exit where it holds [s].
        guesses: initial guesses of its hyperparameters.
    """

    seconds: float
    guesses: Mapping[str, float]


class Estimates:
    """The estimates of one task's instances, each made once however many plans it occurs in."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self._known: dict[tuple[object, ...], Estimate] = {}

    def of(self, instances: Sequence[OrderedInstance]) -> list[Estimate]:
        """Return the estimate of each instance of a plan; they are in the order in which they begin."""
        brought = [(instance, moves) for instance in instances if (moves := self._moves(instance))]
        return [self._estimate(instance, _before(brought, instance)) for instance in instances]

    def _estimate(self, instance: OrderedInstance, moves: Moves) -> Estimate:
        roles = {**instance.slots, **instance.targets}
        key = (instance.block, tuple(roles.items()), tuple(sorted(moves.items())))
        if key not in self._known:
            self._known[key] = self._made(instance.block, roles, moves)
        return self._known[key]

    def _made(self, name: str, roles: Mapping[str, str], moves: Moves) -> Estimate:
        block, binding, state = self.task.domain.block_by_name[name], self.task.bind(roles), self._state(moves)
        guesses = block.guesses(binding, state)
        expected = block.duration.expected(binding, state, guesses)
        bounded = float(np.clip(expected, block.duration.minimum, block.duration.maximum))
        # Whole ticks here already, so that every time that is built from it agrees with the network's.
        seconds = round(math.ceil(bounded / TICK - 1e-6) * TICK, 6)
        return Estimate(seconds, {name: float(value) for name, value in guesses.items()})

    def _state(self, moves: Moves) -> State:
        """Return the initial state with things at the middle of the places where they have been brought."""
        state = self.task.state
        changes = {
            (thing, "position"): np.concatenate(
                [state[place, "position"][..., :2], state[thing, "position"][..., 2:]], axis=-1
            )
            for thing, place in moves.items()
        }
        return state.replace(changes) if changes else state

    def _moves(self, instance: OrderedInstance) -> Moves:
        """Return what the exit conditions of an instance say has come to which place."""
        roles = {**instance.slots, **instance.targets}
        exits = self.task.domain.block_by_name[instance.block].exit
        pairs = (self._pair(literal, roles) for literal in exits)
        return dict(pair for pair in pairs if pair is not None)

    def _pair(self, literal: Literal, roles: Mapping[str, str]) -> tuple[str, str] | None:
        index = literal.predicate.functional_index
        if not literal.positive or index is None or len(literal.arguments) != 2:
            return None
        thing, place = (roles.get(literal.arguments[i], "") for i in (1 - index, index))
        tokens = self.task.token_by_name
        return (thing, place) if thing in tokens and place in tokens and tokens[place].place else None


def _before(brought: Sequence[tuple[OrderedInstance, Moves]], instance: OrderedInstance) -> Moves:
    """Return where things have been brought by the instances that end before this one begins."""
    found: dict[str, str] = {}
    for earlier, moves in brought:
        if earlier.end is not None and earlier.end <= instance.begin:
            found.update(moves)
    return found
