"""What an instance is expected to do: its duration and its final state, as declared or from a rollout.

A block may declare both. If it does not, the instance is rolled out with its continuous system, with one step per
control period, until its exit conditions hold or nothing moves any more.
"""

from dataclasses import dataclass

from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import CONTROL_PERIOD, Hyperparameters
from hybrid_tamp.model.forward_model import roll_out
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.shapes import check_shape
from hybrid_tamp.model.state import State


@dataclass(frozen=True, eq=False)
class Expectation:
    """The expected duration [s] of an instance, and its expected final state, or None if the block does not tell it."""

    seconds: float
    end: State | None


def expect(block: Block, binding: Binding, state: State, hyperparameters: Hyperparameters) -> Expectation:
    """Return what an instance that starts in a state without batch dimensions is expected to do.

    Raises:
        DomainError: a function of the domain raised an exception, or returned a result of the wrong shape.
    """
    seconds, end = _declared_duration(block, binding, state, hyperparameters), declared_end(block, binding, state)
    if seconds is not None:
        return Expectation(seconds, end)
    longest = block.duration.maximum
    states = roll_out(block, binding, state, longest, hyperparameters=hyperparameters, until_still=True)
    return Expectation((len(states) - 1) * CONTROL_PERIOD, states[-1] if end is None and block.moves else end)


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


def _declared_duration(block: Block, binding: Binding, state: State, hyperparameters: Hyperparameters) -> float | None:
    if block.duration.expected is None:
        return None
    where = f"{block.name}.duration"
    with authored(where, binding):
        expected = block.duration.expected(binding, state, hyperparameters)
    check_shape(where, binding, expected, ())
    return float(expected)
