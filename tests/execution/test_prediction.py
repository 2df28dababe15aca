"""Tests of predicted margins in comparison with measured margins."""

from typing import Any

import pytest
from predicted_runs import margins_of, predict

from hybrid_tamp.execution.execute import add_predictions, execute
from hybrid_tamp.physics.protocol import open_backend


def test_every_condition_gets_its_prediction(toys: Any) -> None:
    task, plan = toys.one_move_task(), toys.one_move()
    with open_backend("pybullet") as backend:
        measured = execute(task, plan, backend)
    predicted = predict(task, plan)
    merged = add_predictions(measured, margins_of(predicted))
    assert merged.exits.keys() == measured.exits.keys()
    for mine, theirs in zip(merged.exits["MOVING-1"], predicted.exits["MOVING-1"], strict=True):
        assert mine.predicted == theirs.measured
    assert merged.goal[0].predicted == predicted.goal[0].measured
    assert merged.goal[0].measured == measured.goal[0].measured
    # The toy's forward model describes a free hand exactly.
    near = merged.exits["MOVING-1"][0]
    assert near.measured == pytest.approx(near.predicted, abs=1e-3)


def test_what_was_not_predicted_stays_open(toys: Any) -> None:
    task = toys.one_move_task()
    measured = predict(task, toys.one_move())
    failed = predict(task, toys.one_move(stiffness=float("nan")))
    merged = add_predictions(measured, margins_of(failed))
    assert [margin.predicted for margin in merged.exits["MOVING-1"]] == [None, None]
