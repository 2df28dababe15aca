"""Rollouts to the exit of a block, alone and in batches."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import rolling_task

from hybrid_tamp.model import expectation
from hybrid_tamp.model.arrival import Arrivals, roll_out_to_exit, stack_values
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import Hyperparameters
from hybrid_tamp.model.expectation import Beginning, Expectations, expect
from hybrid_tamp.model.forward_model import roll_out
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task

TASK = rolling_task(hands=2, drums=((0.0, 0.0), (0.0, 0.4)))
ROLES = {"hand": "hand 0", "object": "drum 0", "region": "region 0"}


def undeclared(task: Task, name: str) -> Block:
    block = task.domain.block_by_name[name]
    return replace(block, duration=replace(block.duration, expected=None), outcome=None)


def begin(block: Block, task: Task = TASK, **roles: str) -> Beginning:
    binding = task.bind(ROLES | roles)
    return Beginning(block, binding, task.state, block.initial_values(binding, task.state))


def test_a_rollout_ends_at_the_first_step_at_which_the_exit_conditions_hold() -> None:
    block, one = undeclared(TASK, "REACHING:behind"), begin(undeclared(TASK, "REACHING:behind"))
    starts = TASK.state.repeated(1)
    arrival = roll_out_to_exit(block, one.binding, starts, stack_values([one.hyperparameters]))
    every_step = roll_out(block, one.binding, TASK.state, block.duration.maximum)
    assert arrival.steps[0] == len(every_step) - 1
    np.testing.assert_allclose(arrival.ends.values[0], every_step[-1].values, atol=1e-9)


def test_each_row_of_a_batch_ends_on_its_own() -> None:
    block = undeclared(TASK, "REACHING:behind")
    one = begin(block)
    near = TASK.state.replace({("hand 0", "position"): TASK.state["hand 0", "position"] + [0.2, 0.0, 0.0]})
    values = [one.hyperparameters, block.initial_values(one.binding, near)]
    starts = State(near.layout, np.stack([TASK.state.values, near.values]))
    both = roll_out_to_exit(block, one.binding, starts, stack_values(values))
    assert both.steps[0] != both.steps[1]
    for row, state in enumerate((TASK.state, near)):
        alone = roll_out_to_exit(block, one.binding, state.repeated(1), stack_values([values[row]]))
        assert alone.steps[0] == both.steps[row]
        np.testing.assert_allclose(alone.ends.values[0], both.ends.values[row], atol=1e-9)


def test_a_rollout_that_comes_to_rest_without_its_exit_ends_early() -> None:
    block = replace(undeclared(TASK, "REACHING:behind"), policy=lambda binding, start, parameters: lambda *_: {})
    one = begin(block)
    arrival = roll_out_to_exit(block, one.binding, TASK.state.repeated(1), stack_values([one.hyperparameters]))
    assert 240 <= arrival.steps[0] < 300


def test_equal_instances_of_equal_tokens_share_one_rollout(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[int] = []

    def count(block: Block, binding: Binding, starts: State, hyperparameters: Hyperparameters) -> Arrivals:
        made.append(len(starts.values))
        return roll_out_to_exit(block, binding, starts, hyperparameters)

    monkeypatch.setattr(expectation, "roll_out_to_exit", count)
    block, expectations = undeclared(TASK, "REACHING:behind"), Expectations()
    there = TASK.state.replace({("hand 1", "position"): TASK.state["hand 0", "position"]})
    moved = replace(TASK, state=there)
    first, other, far = expectations.of(
        [begin(block, moved), begin(block, moved, hand="hand 1"), begin(block, moved, object="drum 1")]
    )
    assert made == [2], "two different rollouts are one batch"
    assert first.seconds == other.seconds
    assert first.end is not None
    assert other.end is not None
    np.testing.assert_array_equal(first.end["hand 0", "position"], other.end["hand 1", "position"])
    np.testing.assert_array_equal(other.end["hand 0", "position"], there["hand 0", "position"])
    assert far.seconds != first.seconds
    expectations.of([begin(block, moved, hand="hand 1")])
    assert made == [2], "a known rollout is not repeated"


def test_a_declared_end_tells_poses_and_the_rollout_tells_the_rest() -> None:
    block = TASK.domain.block_by_name["REACHING:behind"]
    assert block.outcome is not None
    one = begin(block)
    told = block.outcome(one.binding, TASK.state)
    rolled = replace(block, duration=replace(block.duration, expected=None))
    found = expect(rolled, one.binding, TASK.state, one.hyperparameters)
    assert found.end is not None
    np.testing.assert_array_equal(found.end["hand 0", "position"], told["hand 0", "position"])
    assert found.seconds == pytest.approx(expect(block, one.binding, TASK.state, one.hyperparameters).seconds, rel=0.2)
