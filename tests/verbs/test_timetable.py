"""A refined plan has the times of its rollout, in every output."""

import json
from pathlib import Path
from typing import Any

import pytest
from contracts.scripts import load_script
from predicted_runs import predict

import hybrid_tamp
from hybrid_tamp.midlevel.refinement import refine
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.verbs.loading import Settings

timetable = load_script("timetable")
FEW = Settings(evaluations=100)


@pytest.mark.parametrize("name", ["hammer_push", "lift_two_hands", "tumble_four_hands"])
def test_the_refined_times_are_those_of_a_run_in_the_forward_models(name: str, tmp_path: Path) -> None:
    result = hybrid_tamp.run(name, tmp_path / "run", FEW, backend="analytic")
    assert result.success
    plan = result.outcome.required()
    assert check_law(result.task, plan) == []
    run = {each.name: each for each in result.recording.instances}
    assert len(run) == len(plan.instances)
    for each in plan.instances:
        times = (run[each.name].start, run[each.name].reached, run[each.name].end)
        assert (each.start, each.reached, each.end) == pytest.approx(times, abs=0.01), each.name
    assert plan.makespan == pytest.approx(result.recording.duration, abs=0.01)
    shown = json.loads((tmp_path / "run" / "plan.json").read_text(encoding="utf-8"))
    assert shown["makespan"] == plan.makespan
    assert [step["start"] for step in shown["steps"]] == list(plan.instants[:-1])
    page = (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    assert f"{plan.makespan:.2f} s" in page


def test_independent_movements_are_planned_in_the_order_of_the_rollout(toys: Any) -> None:
    """The second move ends first, although the planner expected the opposite. The last event settles for 0.5 s."""
    world = toys.world.pusher("far", position=(0, 1, 0.5)).pusher("close", position=(0.3, 0, 0.5))
    task = world.spot("a").spot("b").task(Atom("near", ("close", "b")))
    task = task.replaced(state=task.state.replace({("a", "position"): (0.4, 1, 0.5)}))
    instances = (
        toys.rest("RESTING-1", 0.0, 0.1, "far"),
        toys.rest("RESTING-2", 0.0, 0.1, "close"),
        toys.move("MOVING-1", 0.1, 1.0, "far", "a", stiffness=100.0),
        toys.move("MOVING-2", 0.1, 2.0, "close", "b", stiffness=200.0),
        toys.rest("RESTING-3", 1.0, 2.1, "far"),
        toys.rest("RESTING-4", 2.0, 2.1, "close"),
    )
    plan = refine(task, TaskPlan(instances, 2.1)).plan
    run = predict(task, TaskPlan(instances, 2.1))
    times = {each.name: (each.start, each.end) for each in plan.instances}
    assert times["MOVING-2"][1] < times["MOVING-1"][1]
    assert check_law(task, plan) == []
    for each in run.instances:
        assert times[each.name] == pytest.approx((each.start, each.end), abs=0.001), each.name


def test_the_times_of_a_run_in_physics_are_foreseen() -> None:
    times = timetable.run_task("roll_cylinder")
    assert times.agrees
    assert times.ratio == pytest.approx(1.0, abs=0.02)
