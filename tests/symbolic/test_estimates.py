"""Expected durations and outcomes of blocks, compared with the forward models of the blocks."""

from dataclasses import replace

import numpy as np
import pytest
from predicted_runs import predict
from random_tasks.tumbling import random_tumbling
from scenes import reach_and_roll, rolling_task

from hybrid_tamp.model import expectation
from hybrid_tamp.model.arrival import Arrivals
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import Hyperparameters
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import decode
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.estimates import Estimates
from hybrid_tamp.symbolic.find_plan import find_plan
from hybrid_tamp.symbolic.schedule import schedule

TASKS = {"two hands": random_tumbling(7, 2, 1), "four hands": random_tumbling(7, 4, 1), "a drum": rolling_task()}


@pytest.mark.parametrize("name", TASKS)
def test_tokens_come_to_where_their_blocks_say_and_when(name: str) -> None:
    task: Task = TASKS[name]
    with PlannerProcess() as planner:
        plan = find_plan(task, planner).plan
    assert plan is not None
    run = predict(task, plan)
    assert run.failure is None
    for instance in run.plan.instances:
        block = task.domain.block_by_name[instance.block]
        if block.outcome is None:
            continue
        expected = block.outcome(task.bind(instance.roles), run.at(instance.start))
        for token in instance.slots.values():
            np.testing.assert_allclose(expected[token, "position"], run.at(instance.end)[token, "position"], atol=0.04)
    assert 0.7 * plan.makespan < run.plan.makespan < 1.05 * plan.makespan


def test_a_second_reach_starts_where_the_first_roll_ended() -> None:
    task = rolling_task(regions=[(0.7, 0), (1.4, 0)], goal=[(0, 1)])
    actions = reach_and_roll("hand-0", "drum-0", "region-0")
    actions += reach_and_roll("hand-0", "drum-0", "region-1", "region-0")
    instances = decode(compile_task(task), actions)
    first, second = (
        each
        for instance, each in zip(instances, Estimates(task).of(instances), strict=True)
        if instance.block == "REACHING:behind"
    )
    assert second.seconds < first.seconds
    # The expected roll ends a few millimetres from the middle of the region.
    moved = second.outcome["hand 0", "position"][0] - first.outcome["hand 0", "position"][0]
    assert moved == pytest.approx(0.7, abs=0.005)


def test_instances_with_known_beginnings_are_rolled_out_together(monkeypatch: pytest.MonkeyPatch) -> None:
    task = rolling_task(hands=2, drums=((0.0, 0.0), (0.0, 0.6)), regions=((0.7, 0.0), (0.7, 0.6)))
    blocks = [replace(each, duration=replace(each.duration, expected=None)) for each in task.domain.blocks]
    task = replace(task, domain=task.domain.with_blocks(blocks))
    actions = [each for n in "01" for each in reach_and_roll(f"hand-{n}", f"drum-{n}", f"region-{n}")]
    batches: list[tuple[str, int]] = []
    roll_out = expectation.roll_out_to_exit

    def count(block: Block, binding: Binding, starts: State, hyperparameters: Hyperparameters) -> Arrivals:
        batches.append((block.name, len(starts.values)))
        return roll_out(block, binding, starts, hyperparameters)

    monkeypatch.setattr(expectation, "roll_out_to_exit", count)
    estimates = Estimates(task)
    estimates.of(decode(compile_task(task), actions))
    assert batches == [("REACHING:behind", 2), ("ROLLING", 2)]
    estimates.of(decode(compile_task(task), actions))
    assert len(batches) == 2


def test_an_estimate_is_made_once() -> None:
    task = rolling_task()
    instances = decode(compile_task(task), reach_and_roll("hand-0", "drum-0", "region-0"))
    estimates = Estimates(task)
    assert all(one is other for one, other in zip(estimates.of(instances), estimates.of(instances), strict=True))
    assert schedule(task, instances, (), estimates) == schedule(task, instances)
