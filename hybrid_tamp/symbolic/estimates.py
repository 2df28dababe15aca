"""Expected durations of the instances of a plan.

The duration of an instance is estimated in the state in which the instance is expected to begin. This state follows
from the earlier instances of the plan. Each instance moves its tokens to the poses that the `outcome` of the block
computes. Without an `outcome`, a token moves to the centre of the place that an exit condition assigns to the token.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.expectation import expect
from hybrid_tamp.model.predicate import Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.symbolic.decode import OrderedInstance

TICK = 1e-3
"""Resolution of times [s]. Times are multiples of `TICK`, so that rounding errors cannot make a schedule infeasible."""

_POSE = ("position", "orientation")
_DIGITS = 6

Poses = Mapping[tuple[str, str], FloatArray]
"""Maps pairs of (token, property) to the value of the property."""


@dataclass(frozen=True)
class Estimate:
    """The expected duration and outcome of one instance.

    Attributes:
        seconds: Time from the beginning of the instance until its exit conditions hold [s].
        initial_values: Maps each hyperparameter to its initial value.
        outcome: Poses of the tokens when the exit conditions hold.
    """

    seconds: float
    initial_values: Mapping[str, float]
    outcome: Poses


class Estimates:
    """The estimates of the instances of one task. Instances with equal roles in equal poses share one estimate."""

    def __init__(self, task: Task, deadline: Deadline = NEVER) -> None:
        self.task = task
        self._deadline = deadline
        self._known: dict[tuple[object, ...], Estimate] = {}

    def of(self, instances: Sequence[OrderedInstance]) -> list[Estimate]:
        """Return the estimates of the instances of a plan. The instances must be in the order of their beginnings.

        Raises:
            LimitReached: If the deadline passes.
        """
        return [estimate for _, estimate in self._follow(instances)]

    def states(self, instances: Sequence[OrderedInstance]) -> list[State]:
        """Return the expected state in which each instance of a plan begins, in the order of their beginnings.

        Raises:
            LimitReached: If the deadline passes.
        """
        return [state for state, _ in self._follow(instances)]

    def _follow(self, instances: Sequence[OrderedInstance]) -> Iterator[tuple[State, Estimate]]:
        """Yield the expected state in which each instance begins, and the estimate of the instance."""
        state = self.task.state
        coming: list[tuple[int, Poses]] = []
        for instance in instances:
            self._deadline.check()
            ready = [poses for event, poses in coming if event <= instance.begin]
            coming = [(event, poses) for event, poses in coming if event > instance.begin]
            state = state.replace({key: value for poses in ready for key, value in poses.items()}) if ready else state
            estimate = self._estimate(instance, state)
            yield state, estimate
            if estimate.outcome:
                coming.append((self._event(instance), estimate.outcome))

    def _event(self, instance: OrderedInstance) -> int:
        """Return the first reassignment at which other instances may read the tokens that the instance has moved."""
        hold = self.task.domain.block_by_name[instance.block].hold
        return instance.begin + 1 if hold or instance.end is None else instance.end

    def _estimate(self, instance: OrderedInstance, state: State) -> Estimate:
        roles = {**instance.slots, **instance.targets}
        tokens = [name for name in roles.values() if name in self.task.token_by_name]
        poses = [state[name, p].round(_DIGITS).tobytes() for name in tokens for p in _properties(state, name)]
        key = (instance.block, tuple(roles.items()), *poses)
        if key not in self._known:
            self._known[key] = self._make(self.task.domain.block_by_name[instance.block], roles, state)
        return self._known[key]

    def _make(self, block: Block, roles: Mapping[str, str], state: State) -> Estimate:
        binding = self.task.bind(roles)
        initial = block.initial_values(binding, state)
        expected = expect(block, binding, state, initial)
        bounded = float(np.clip(expected.seconds, block.duration.minimum, block.duration.maximum))
        # The duration is a whole number of ticks, so that sums of durations are exact.
        seconds = round(math.ceil(bounded / TICK - 1e-6) * TICK, 6)
        values = {name: float(value) for name, value in initial.items()}
        return Estimate(seconds, values, self._outcome(block, roles, expected.end, state))

    def _outcome(self, block: Block, roles: Mapping[str, str], after: State | None, state: State) -> Poses:
        if after is None:
            placed = [self._place(literal, roles, state) for literal in block.exit]
            return {key: value for each in placed for key, value in each.items()}
        tokens = [roles[slot.name] for slot in block.slots]
        return {(name, p): after[name, p].copy() for name in tokens for p in _properties(state, name)}

    def _place(self, literal: Literal, roles: Mapping[str, str], state: State) -> Poses:
        """Return the position of a token above the centre of the place that an exit condition assigns to it."""
        index = literal.predicate.functional_index
        if not literal.positive or index is None or len(literal.arguments) != 2:
            return {}
        thing, place = (roles.get(literal.arguments[i], "") for i in (1 - index, index))
        tokens = self.task.token_by_name
        if thing not in tokens or place not in tokens or not tokens[place].place:
            return {}
        there, here = state[place, "position"], state[thing, "position"]
        return {(thing, "position"): np.concatenate([there[..., :2], here[..., 2:]], axis=-1)}


def _properties(state: State, name: str) -> list[str]:
    return [p for p in _POSE if (name, p) in state.layout.slices]
