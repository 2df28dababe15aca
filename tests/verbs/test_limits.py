"""Tests of the time limit of a command: the results of a run that the limit ends, and that the clock changes no run."""

import json
from pathlib import Path

import numpy as np
import pytest
from clocks import Counted, hurried

import hybrid_tamp
from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.task import Limits, Task
from hybrid_tamp.verbs.run import run


@pytest.fixture(scope="module")
def planned() -> PlanOutcome:
    task = hybrid_tamp.load_task("roll_cylinder").replaced(limits=Limits(time=1e6))
    return hybrid_tamp.plan(task)


def test_what_was_found_before_the_limit_is_in_the_folder(planned: PlanOutcome, tmp_path: Path) -> None:
    def find_plan(task: Task) -> PlanOutcome:
        return planned

    whole = Counted()
    result = run(planned.task, tmp_path / "whole", backend="analytic", find_plan=find_plan, deadline=whole)
    count, pictures, steps = len(whole.checks), len(list(result.recording.plan.steps)), len(result.recording.commands)
    left = {"optimising": 1, "running": count - pictures - steps // 2, "drawing": count - 1}
    for stage, most in left.items():
        folder = tmp_path / stage
        with pytest.raises(LimitReached):
            run(planned.task, folder, backend="analytic", find_plan=find_plan, deadline=Counted(5.0, most=most))
        assert json.loads((folder / "plan.json").read_text())["steps"]
        assert (folder / "result.json").exists() == (stage == "drawing")
        assert (folder / "report.html").exists()
        status = json.loads((folder / "plan.json").read_text())["status"]
        assert status == ("limit" if stage == "optimising" else "solved")


def test_no_clock_changes_a_run(planned: PlanOutcome, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    idle = run(planned.task, tmp_path / "idle", backend="analytic")
    hurried(monkeypatch, jump=10.0)
    busy = run(planned.task, tmp_path / "busy", backend="analytic")
    assert np.array_equal(idle.recording.states, busy.recording.states)
    assert np.array_equal(idle.recording.commands, busy.recording.commands)
    assert busy.outcome.plan == idle.outcome.plan
    assert (busy.performance, busy.metrics) == (idle.performance, idle.metrics)
