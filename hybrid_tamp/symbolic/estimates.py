"""Expected durations of the instances of a plan.

The duration of an instance is estimated in the state in which the instance is expected to begin. This state follows
from the earlier instances of the plan. Each instance moves its tokens to the poses that the `outcome` of the block
computes. Without an `outcome`, a token moves to the centre of the place that an exit condition assigns to the token.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.expectation import Beginning, Expectation, Expectations
from hybrid_tamp.model.predicate import Literal, name_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.symbolic.decode import OrderedInstance

TICK = 1e-3
"""Resolution of times [s]. Times are multiples of `TICK`, so that rounding errors cannot make a schedule infeasible."""

_DIGITS = 6

Poses = Mapping[tuple[str, str], FloatArray]
"""Maps pairs of (token, property) to the value of the property."""


@dataclass(frozen=True)
class Estimate:
    """The expected duration and outcome of one instance.

    Attributes:
        seconds: Time from the beginning of the instance until its exit conditions hold [s].
        initial_values: Maps each hyperparameter to its initial value.
        outcome: Varying properties of the tokens when the exit conditions hold, e.g. their poses.
    """

    seconds: float
    initial_values: Mapping[str, float]
    outcome: Poses


_Key = tuple[object, ...]


@dataclass(frozen=True, eq=False)
class _Step:
    """An instance, the expected state in which it begins, and its estimate, or None if it is not known yet.

    `state` is None if the instance begins in a state that follows from an instance without an estimate.
    """

    instance: OrderedInstance
    state: State | None
    key: _Key = ()
    estimate: Estimate | None = None


class Estimates:
    """The estimates of the instances of one task. Instances with equal roles in equal poses share one estimate."""

    def __init__(self, task: Task, deadline: Deadline = NEVER, expectations: Expectations | None = None) -> None:
        """Make the estimates of a task.

        Args:
            task: Task of the instances.
            deadline: Deadline of the command.
            expectations: Expectations of instances, which several tasks may share. New expectations are made if None.
        """
        self.task = task
        self._deadline = deadline
        self._expectations = expectations or Expectations()
        self._known: dict[_Key, Estimate] = {}
        self._columns: dict[str, list[int]] = {token.name: [] for token in task.tokens}
        for (name, _), columns in task.state.layout.slices.items():
            self._columns[name] += range(columns.start, columns.stop)

    def of(self, instances: Sequence[OrderedInstance]) -> list[Estimate]:
        """Return the estimates of the instances of a plan. The instances must be in the order of their beginnings.

        Raises:
            LimitReached: If the deadline passes.
        """
        return [estimate for _, estimate in self._complete(instances)]

    def states(self, instances: Sequence[OrderedInstance]) -> list[State]:
        """Return the expected state in which each instance of a plan begins, in the order of their beginnings.

        Raises:
            LimitReached: If the deadline passes.
        """
        return [state for state, _ in self._complete(instances)]

    def _complete(self, instances: Sequence[OrderedInstance]) -> list[tuple[State, Estimate]]:
        """Return the expected state in which each instance begins, and the estimate of the instance.

        All instances whose expected states are known are estimated together, because similar rollouts form one batch.
        """
        while True:
            steps = list(self._follow(instances))
            unknown = {step.key: step for step in steps if step.state is not None and step.estimate is None}
            if not unknown:
                return [(step.state, step.estimate) for step in steps if step.state is not None and step.estimate]
            self._deadline.check()
            self._known.update(zip(unknown, self._make(list(unknown.values())), strict=True))

    def _follow(self, instances: Sequence[OrderedInstance]) -> Iterator[_Step]:
        """Yield a step for each instance."""
        state, lost = self.task.state, set[str]()
        coming: list[tuple[int, Poses, Iterable[str]]] = []
        for instance in instances:
            self._deadline.check()
            ready = [(poses, tokens) for event, poses, tokens in coming if event <= instance.begin]
            coming = [each for each in coming if each[0] > instance.begin]
            lost.update(token for _, tokens in ready for token in tokens)
            changes = {key: value for poses, _ in ready for key, value in poses.items()}
            state = state.replace(changes) if changes else state
            step = self._step(instance, state, lost)
            yield step
            if step.estimate is None:
                coming.append((self._event(instance), {}, instance.slots.values()))
            elif step.estimate.outcome:
                coming.append((self._event(instance), step.estimate.outcome, ()))

    def _event(self, instance: OrderedInstance) -> int:
        """Return the first reassignment at which other instances may read the tokens that the instance has moved."""
        hold = self.task.domain.block_by_name[instance.block].hold
        return instance.begin + 1 if hold or instance.end is None else instance.end

    def _step(self, instance: OrderedInstance, state: State, lost: Set[str]) -> _Step:
        """Return the step of an instance. `lost` are the tokens whose expected poses are not known yet."""
        roles = {**instance.slots, **instance.targets}
        if not lost.isdisjoint(roles.values()):
            return _Step(instance, None)
        tokens = [name for name in roles.values() if name in self.task.token_by_name]
        poses = [(state.values[self._columns[name]].round(_DIGITS) + 0.0).tobytes() for name in tokens]
        key = (instance.block, tuple(roles.items()), *poses)
        return _Step(instance, state, key, self._known.get(key))

    def _make(self, steps: Sequence[_Step]) -> list[Estimate]:
        beginnings = []
        for step in steps:
            block, state = self.task.domain.block_by_name[step.instance.block], step.state
            assert state is not None, "the expected state is not known"
            binding = self.task.bind({**step.instance.slots, **step.instance.targets})
            beginnings.append(Beginning(block, binding, state, block.initial_values(binding, state)))
        expected = self._expectations.of(beginnings)
        return [self._estimate(begin, each) for begin, each in zip(beginnings, expected, strict=True)]

    def _estimate(self, begin: Beginning, expected: Expectation) -> Estimate:
        block = begin.block
        bounded = float(np.clip(expected.seconds, block.duration.minimum, block.duration.maximum))
        # The duration is a whole number of ticks, so that sums of durations are exact.
        seconds = round(math.ceil(bounded / TICK - 1e-6) * TICK, 6)
        values = {name: float(value) for name, value in begin.hyperparameters.items()}
        roles = {role: name_of(value) for role, value in begin.binding.items()}
        return Estimate(seconds, values, self._outcome(block, roles, expected.end, begin.state))

    def _outcome(self, block: Block, roles: Mapping[str, str], after: State | None, state: State) -> Poses:
        if after is None:
            placed = [self._place(literal, roles, state) for literal in block.exit]
            return {key: value for each in placed for key, value in each.items()}
        tokens = [roles[slot.name] for slot in block.slots]
        varying = {name: self.task.token_by_name[name].varying for name in tokens}
        return {(name, p.name): after[name, p.name].copy() for name in tokens for p in varying[name]}

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
