"""A refined plan has the times of its rollout, in every output."""

import json
from pathlib import Path

import pytest
from contracts.scripts import load_script

import hybrid_tamp
from hybrid_tamp.model.law import check_law
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


def test_the_times_of_a_run_in_physics_are_foreseen() -> None:
    times = timetable.run_task("roll_cylinder")
    assert times.agrees
    assert times.ratio == pytest.approx(1.0, abs=0.02)
