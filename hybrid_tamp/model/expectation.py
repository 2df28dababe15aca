"""What an instance is expected to do: its duration and its final state, as declared or from a rollout.

A block may declare both. If it does not, the instance is rolled out with its continuous system, with one step per
control period, until its exit conditions hold or nothing moves any more. A policy and a continuous system see only the
tokens of their instance. So instances whose tokens have equal properties are rolled out as one batch, and the rollout
of an instance also serves every later instance whose tokens have the same properties and states.
"""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.model.affordance import BODY_STATE
from hybrid_tamp.model.arrival import roll_out_to_exit, stack_values
from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Hyperparameters, Parameters
from hybrid_tamp.model.course import Course
from hybrid_tamp.model.key_pose import KeyPose
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.shapes import check_shape
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.model.view import View
from hybrid_tamp.motion.arrays import FloatArray

_DIGITS = 6
"""Number of decimals to which two states must agree to share a rollout, in SI units."""

_MOTION = frozenset(varying.name for varying in BODY_STATE)


@dataclass(frozen=True, eq=False)
class Expectation:
    """The expected duration [s] of an instance, and its expected final state, or None if the block does not tell it."""

    seconds: float
    end: State | None


@dataclass(frozen=True, eq=False)
class Beginning:
    """The beginning of an instance.

    Attributes:
        block: block of the instance.
        binding: maps each role of the block to its token or symbol.
        state: state in which the instance begins, without batch dimensions.
        hyperparameters: maps each hyperparameter to its value, shape ``()``.
    """

    block: Block
    binding: Binding
    state: State
    hyperparameters: Hyperparameters


@dataclass(frozen=True, eq=False)
class _Rolled:
    """The duration of a rollout [s], and the final values ``(m,)`` of the instance's tokens."""

    seconds: float
    values: FloatArray


class Expectations:
    """Expectations of instances. Equal rollouts are made once, and similar rollouts as one batch."""

    def __init__(self) -> None:
        self._known: dict[Hashable, _Rolled] = {}

    def of(self, beginnings: Sequence[Beginning]) -> list[Expectation]:
        """Return what each instance is expected to do.

        Raises:
            DomainError: a function of the domain raised an exception, or returned a result of the wrong shape.
        """
        seconds = [declared_duration(e.block, e.binding, e.state, e.hyperparameters) for e in beginnings]
        missing = [each for each, told in zip(beginnings, seconds, strict=True) if told is None and each.block.moves]
        rolled = iter(self._roll_out(missing))
        found = []
        for each, told in zip(beginnings, seconds, strict=True):
            end = declared_end(each.block, each.binding, each.state)
            if told is None and each.block.moves:
                mine = next(rolled)
                found.append(Expectation(mine.seconds, _combine(each, end, mine)))
            else:  # A block that moves nothing has nothing to wait for.
                found.append(Expectation(each.block.duration.minimum if told is None else told, end))
        return found

    def _roll_out(self, beginnings: Sequence[Beginning]) -> list[_Rolled]:
        groups: dict[Hashable, dict[Hashable, Beginning]] = {}
        keys: list[tuple[Hashable, Hashable]] = []
        for each in beginnings:
            kind, own = _kind(each), _values(each)
            rounded: Hashable = (own.round(_DIGITS) + 0.0).tobytes(), *(float(v) for v in each.hyperparameters.values())
            keys.append((kind, rounded))
            if keys[-1] not in self._known:
                groups.setdefault(kind, {}).setdefault(rounded, each)
        for kind, group in groups.items():
            for rounded, rolled in zip(group, _roll_out_together(list(group.values())), strict=True):
                self._known[kind, rounded] = rolled
        return [self._known[key] for key in keys]


def expect(block: Block, binding: Binding, state: State, hyperparameters: Hyperparameters) -> Expectation:
    """Return what an instance that starts in a state without batch dimensions is expected to do.

    Raises:
        DomainError: a function of the domain raised an exception, or returned a result of the wrong shape.
    """
    return Expectations().of([Beginning(block, binding, state, hyperparameters)])[0]


def declared_duration(block: Block, binding: Binding, state: State, hyperparameters: Hyperparameters) -> float | None:
    """Return the duration [s] that the block declares for an instance, or None. The state has no batch dimensions.

    Raises:
        DomainError: the function raised an exception, or returned a result of the wrong shape.
    """
    if block.duration.expected is None:
        return None
    where = f"{block.name}.duration"
    with authored(where, binding):
        expected = block.duration.expected(binding, state, hyperparameters)
    check_shape(where, binding, expected, ())
    return float(expected)


def declared_end(block: Block, binding: Binding, state: State) -> State | None:
    """Return the final state that the block declares, or None. The state may have batch dimensions.

    Raises:
        DomainError: the function raised an exception, or returned a state of another shape.
    """
    if block.outcome is None:
        return None
    where = f"{block.name}.outcome"
    with authored(where, binding):
        after = block.outcome(binding, state)
    check_shape(where, binding, after.values, state.values.shape)
    return after


def declared_course(block: Block, binding: Binding, start: State, parameters: Parameters) -> Course | None:
    """Return the course that the block declares, or None. A block that moves nothing stays in its start ``(n,)``.

    Raises:
        DomainError: the function raised an exception, or returned states of another shape.
    """
    if not block.moves:
        return Course(start.repeated(1))
    if block.sweep is None:
        return None
    where = f"{block.name}.sweep"
    with authored(where, binding):
        course = block.sweep(binding, start, parameters)
    if course is not None:
        shape = (*course.states.values.shape[:1], start.values.size)
        check_shape(where, binding, course.states.values, shape)
    return course


def declared_key_poses(block: Block, binding: Binding, start: State) -> Sequence[KeyPose]:
    """Return the key poses that the block declares for an instance, or an empty list.

    Raises:
        DomainError: the function raised an exception, or returned a pose of another shape.
    """
    if block.key_poses is None:
        return []
    where = f"{block.name}.key_poses"
    with authored(where, binding):
        poses = block.key_poses(binding, start)
    for pose in poses:
        check_shape(where, binding, pose.position, (3,))
        check_shape(where, binding, pose.orientation, (4,))
    return poses


def _roll_out_together(beginnings: Sequence[Beginning]) -> list[_Rolled]:
    """Roll out instances of one block whose tokens have equal properties, with the tokens of the first instance."""
    block, binding, state = beginnings[0].block, beginnings[0].binding, beginnings[0].state
    starts = State(View(binding, state.layout).layout, np.stack([_values(each) for each in beginnings]))
    arrivals = roll_out_to_exit(block, binding, starts, stack_values([each.hyperparameters for each in beginnings]))
    seconds = arrivals.steps * CONTROL_PERIOD
    return [_Rolled(float(each), values) for each, values in zip(seconds, arrivals.ends.values, strict=True)]


def _values(begin: Beginning) -> FloatArray:
    return View(begin.binding, begin.state.layout).of(begin.state).values


def _combine(begin: Beginning, declared: State | None, rolled: _Rolled) -> State:
    """Return the end of a rollout. A declared end tells the poses of bodies at rest, and whatever else it changes."""
    view = View(begin.binding, begin.state.layout)
    end = view.update(begin.state, State(view.layout, rolled.values))
    if declared is None:
        return end
    told = {
        (token, name): declared[token, name]
        for token, name, _ in view.layout.entries
        if name in _MOTION or not np.array_equal(declared[token, name], begin.state[token, name])
    }
    return end.replace(told)


def _kind(begin: Beginning) -> Hashable:
    """Return a key. Instances with equal keys move in the same way if their tokens have the same states."""
    block, values = begin.block, tuple(begin.binding.values())
    system = block.system or (*block.writes.items(), *block.attached.items())
    moves = block.policy, system, block.duration, block.measured_exits, block.hyperparameters
    by_name = any(literal.predicate.by_name for literal in block.measured_exits)
    roles = tuple(begin.binding)
    tokens = (value.name if by_name else value.fixed for value in values if isinstance(value, Token))
    places = tuple(value if isinstance(value, str) else values.index(value) for value in values)
    return moves, roles, places, tuple(tokens)
