"""Plans with the same beginning continue from a snapshot, bit-identically to runs from the start."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hammer_figures import figure_plan, figure_task
from midlevel.plans import reach_and_roll
from scenes import rolling_task

from hybrid_tamp.execution import loop as execution
from hybrid_tamp.execution.execute import execute, execute_variants
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.physics.protocol import Backend, open_backend


def with_value(plan: TaskPlan, instance: str, name: str, value: float) -> TaskPlan:
    instances = [
        replace(i, hyperparameters={**i.hyperparameters, name: value}) if i.name == instance else i
        for i in plan.instances
    ]
    return replace(plan, instances=tuple(instances))


def assert_same(one: Recording, other: Recording) -> None:
    assert np.array_equal(one.states, other.states)
    assert np.array_equal(one.commands, other.commands)
    assert one.instances == other.instances
    assert (one.exits, one.goal, one.contacts) == (other.exits, other.goal, other.contacts)


@pytest.fixture(params=["analytic", "pybullet"])
def backend(request: Any) -> Iterator[Backend]:
    with open_backend(request.param) as opened:
        yield opened


def test_variants_of_a_roll_are_what_runs_from_the_start_are(backend: Backend) -> None:
    task = rolling_task()
    plans = [with_value(reach_and_roll(task), "ROLLING-1", "distance", value) for value in (0.69, 0.71, 0.7)]
    whole = [execute(task, plan, backend) for plan in plans]
    assert len({recording.states.tobytes() for recording in whole}) == len(plans)
    for one, other in zip(whole, execute_variants(task, plans, backend), strict=True):
        assert one.success
        assert_same(one, other)


@pytest.mark.parametrize(
    ("instance", "name", "values"),
    [("GRASPING-1", "grasp_location", (0.05, 0.09)), ("CARRYING-1", "duration", (1.5, 2.0))],
)
def test_a_tool_that_stands_and_one_that_is_held(instance: str, name: str, values: tuple[float, float]) -> None:
    task, plan = figure_task("strike", 0.5), figure_plan("strike")
    plans = [with_value(plan, instance, name, value) for value in values]
    with open_backend("pybullet") as backend:
        alone = [recording for each in plans for recording in execute_variants(task, [each], backend, instance)]
        together = list(execute_variants(task, plans, backend, instance))
    assert not np.array_equal(alone[0].states[-1], alone[1].states[-1])
    for one, other in zip(alone, together, strict=True):
        assert one.failure is None
        assert one.instances[-1].name == instance
        assert_same(one, other)


def test_what_they_have_in_common_is_run_once(monkeypatch: Any) -> None:
    task = rolling_task()
    plans = [with_value(reach_and_roll(task), "ROLLING-1", "distance", value) for value in (0.69, 0.71)]
    steps: list[float] = []
    step = execution.Run._step
    monkeypatch.setattr(execution.Run, "_step", lambda run: (steps.append(run._time), step(run)))
    with open_backend("analytic") as backend:
        recordings = list(execute_variants(task, plans, backend))
    begun = recordings[0].plan.timeline("drum 0")[1][0].start
    assert steps.count(0.0) == 1
    assert sum(len(recording.commands) for recording in recordings) - len(steps) == round(begun * 240)


def test_a_common_failure_is_every_ones(toys: Any) -> None:
    task = toys.one_move_task(policy=lambda b, s, p: lambda t, s: {("pusher", "force"): np.full(3, np.nan)})
    plan = toys.one_move()
    plan = replace(plan, instances=(*plan.instances[:2], replace(plan.instances[2], name="RESTING-2")))
    plans = [with_value(plan, "RESTING-2", "none", value) for value in (1.0, 2.0)]
    with open_backend("analytic") as backend:
        failures = [recording.failure for recording in execute_variants(task, plans, backend)]
    assert [failure and failure.instance for failure in failures] == ["MOVING-1", "MOVING-1"]
