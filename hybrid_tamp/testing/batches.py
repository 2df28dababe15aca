"""Checks that the functions of a domain compute the same results for a batch of states as for each state alone.

A function can mix the states of a batch, e.g. because a call of numpy lacks ``axis``. The results of this function can
have the right shape but wrong values.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import Commands, Parameters
from hybrid_tamp.model.expectation import declared_end
from hybrid_tamp.model.forward_model import ForwardModel
from hybrid_tamp.model.measure import Measure
from hybrid_tamp.model.predicate import Binding, Literal
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.testing.disagreement import Disagreements
from hybrid_tamp.testing.rollouts import Rollouts

_TIMES = (0.0, 0.1, 1.0)
"""Elapsed times at which policies and systems are compared [s]."""
_TOLERANCE = 1e-9
"""Largest relative and absolute difference between two results that counts as a rounding error."""


def check_batches(rolled: Rollouts, found: Disagreements) -> None:
    """Compare the results of a block's functions for a batch of states with the results for each state alone.

    Args:
        rolled: rollouts of the block. The batch contains states at the start, in the middle and at the end.
        found: collection to which disagreements are added.

    Raises:
        DomainError: a result has the wrong shape.
    """
    batch = _states_of(rolled)
    for what, whole, alone in _results(rolled, batch):
        for row in range(len(batch.values)):
            one, other = whole[row], alone[row]
            if not _equal(one, other):
                measured = f"for state {row}, the result is {_text(one)} in the batch and {_text(other)} alone"
                declared = f"{what} has the same results for a batch of states as for each state alone"
                found.add("batch", rolled.block, rolled.binding, declared, measured)
                break


_Result = tuple[str, FloatArray, list[FloatArray]]
"""Triple of (name of a function, results for the batch, result for each state alone)."""


def _states_of(rolled: Rollouts) -> State:
    """Return a batch of states from the start, the middle and the ends of the rollouts, shape ``(4,)``."""
    rows = rolled.rows or [0]
    values = [rolled.start.values, rolled.states.values[rolled.lengths[rows[0]] // 2, rows[0]]]
    values += [rolled.end(row).values for row in (rows[0], rows[-1])]
    return State(rolled.states.layout, np.stack(values))


def _row(state: State, row: int) -> State:
    return State(state.layout, state.values[row])


def _results(rolled: Rollouts, batch: State) -> Iterator[_Result]:
    block, binding = rolled.block, rolled.binding
    conditions: dict[str, Literal] = {}
    for literal in (*block.predicted_entries, *block.measured_exits, *block.invariants):
        conditions.setdefault(literal.predicate.name, literal)
    for name, literal in conditions.items():
        yield _compare_margins(f"predicate {name}", literal, rolled, batch)
    ends = declared_end(block, binding, batch)
    if ends is not None:
        yield "the outcome", ends.values, [_end(block, binding, _row(batch, row)) for row in range(len(batch.values))]
    values = block.initial_values(binding, batch)
    alone = [block.initial_values(binding, _row(batch, row)) for row in range(len(batch.values))]
    for name in values:
        rows = np.broadcast_to(values[name], len(batch.values))
        yield f"initial value {name}", rows, [np.asarray(one[name]) for one in alone]
    chosen = {name: np.broadcast_to(value, len(batch.values)).copy() for name, value in values.items()}
    yield from _compare_models(rolled, batch, chosen)


def _end(block: Block, binding: Binding, state: State) -> FloatArray:
    end = declared_end(block, binding, state)
    assert end is not None
    return end.values


def _compare_margins(what: str, literal: Literal, rolled: Rollouts, batch: State) -> _Result:
    """Compare the margins of a batch of shape ``(2, m)``. The second row has the states in reverse order."""
    twice = State(batch.layout, np.stack([batch.values, batch.values[::-1]]))
    margins = np.broadcast_to(literal.margin(twice, rolled.binding), twice.values.shape[:-1])
    pairs = np.stack([margins[0], margins[1][::-1]], axis=-1)
    alone = [np.repeat(literal.margin(_row(batch, row), rolled.binding), 2) for row in range(len(batch.values))]
    return what, pairs, alone


def _compare_models(rolled: Rollouts, batch: State, chosen: Mapping[str, FloatArray]) -> Iterator[_Result]:
    """Compare the commands, the next states and the measures."""
    block, binding = rolled.block, rolled.binding
    each = [{name: value[row] for name, value in chosen.items()} for row in range(len(batch.values))]
    model = ForwardModel(block, binding, batch, Parameters(chosen))
    single = [ForwardModel(block, binding, _row(batch, row), Parameters(each[row])) for row in range(len(each))]
    for elapsed in map(np.float64, _TIMES):
        after, commands, _ = model.step(elapsed, batch)
        alone = [one.step(elapsed, _row(batch, row)) for row, one in enumerate(single)]
        for key in commands:
            what = f"the policy ({key[1]} of {key[0]})"
            yield what, commands[key], [one[1][key] for one in alone]
        if not all(_equal(commands[key][row], one[1][key]) for row, one in enumerate(alone) for key in commands):
            continue  # The next states differ because the commands differ.
        yield "the system", after.values, [one[0].values for one in alone]
        for measure in block.performance:
            whole = _measure(rolled, measure, batch, after, commands, chosen)
            rows = [
                _measure(rolled, measure, _row(batch, row), one[0], one[1], each[row]) for row, one in enumerate(alone)
            ]
            yield f"measure {measure.name}", whole, rows


def _measure(
    rolled: Rollouts,
    measure: Measure,
    before: State,
    after: State,
    commands: Commands,
    chosen: Mapping[str, FloatArray],
) -> FloatArray:
    """Return the value of a measure for one step, shape ``(...)``."""
    name, binding = rolled.block.name, rolled.binding
    if measure.end is not None:
        return measure.at_end(name, binding, before, after, chosen)
    return measure.during(name, binding, after, commands)


def _equal(one: FloatArray, other: FloatArray) -> bool:
    return np.shape(one) == np.shape(other) and bool(
        np.allclose(one, other, rtol=_TOLERANCE, atol=_TOLERANCE, equal_nan=True)
    )


def _text(value: FloatArray) -> str:
    return np.array2string(np.asarray(value), precision=4, threshold=6)
