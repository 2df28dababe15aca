"""The bounds of a domain on its metrics are part of the verdict of a run."""

from dataclasses import replace

import pytest
from predicted_runs import predict
from random_tasks.tumbling import random_tumbling

import hybrid_tamp
from hybrid_tamp.model.run_result import OutOfBounds, RunResult
from hybrid_tamp.report.documents import document


@pytest.fixture(scope="module")
def result() -> RunResult:
    task = random_tumbling(3)
    outcome = hybrid_tamp.plan(task)
    return RunResult(outcome, predict(task, outcome.required()), {}, 0.0, {}, (), ())


def test_metrics_within_their_bounds_are_a_success(result: RunResult) -> None:
    good = replace(result, metrics={"TIPPING:lower-1.tilt [deg]": 90.0, "TIPPING:lower-1.yaw [deg]": 15.0})
    assert good.out_of_bounds == ()
    assert good.success


def test_a_metric_outside_its_bounds_is_none(result: RunResult) -> None:
    bad = replace(result, metrics={"TIPPING:lower-1.touchdown [rad/s]": 2.9, "planned_duration [s]": 1e9})
    assert bad.recording.success
    assert not bad.success
    assert bad.out_of_bounds == (OutOfBounds("TIPPING:lower-1.touchdown [rad/s]", 2.9, 0.0, 2.0),)
    assert document(bad)["out_of_bounds"] == ["TIPPING:lower-1.touchdown [rad/s] must be between 0 and 2, got 2.9"]
    assert document(bad)["success"] is False


def test_a_metric_that_is_not_a_number_is_no_success(result: RunResult) -> None:
    assert not replace(result, metrics={"TIPPING:lower-1.slip [m]": float("nan")}).success
