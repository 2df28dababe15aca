"""Runs of joint lifting in PyBullet, with checks of the law, measures and contacts (see also scripts/campaign)."""

from pathlib import Path

import numpy as np
import pytest
from hybrid_tamp_domains.joint_lifting.load import squeeze_for
from hybrid_tamp_domains.joint_lifting.metrics import CONTROLLED
from hybrid_tamp_domains.joint_lifting.places import Roles
from predicted_runs import predict
from random_tasks.lifting import random_lifting

import hybrid_tamp
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.report.measures import CONTACT, MEASURED, PLANNED, run_measures
from hybrid_tamp.skills import gap_to_face
from hybrid_tamp.taskfile.loader import load_task

PROBLEMS = Path(__file__).parents[2] / "problems"


def run(task: Task) -> tuple[Recording, dict[str, float]]:
    """Plan and run a task, and check that the run is lawful and that the lift is controlled."""
    plan = hybrid_tamp.plan(task).required()
    with open_backend("pybullet") as physics:
        recording = execute(task, plan, physics)
    assert recording.success
    assert not check_law(task, recording.plan, recording.at)
    assert task.domain.metrics is not None
    found = {name: value for (_, name), value in task.domain.metrics(task, recording).items()}
    for name, (low, high) in CONTROLLED.items():
        assert low <= found[name] <= high, name
    return recording, found | dict(run_measures(plan, recording))


@pytest.mark.parametrize(("name", "mode"), [("lift_two_hands", "two"), ("lift_four_hands", "four")])
def test_hands_lift_a_box_and_bear_it_to_the_end(name: str, mode: str) -> None:
    task = load_task(PROBLEMS / f"{name}.yaml")
    recording, found = run(task)
    assert found[CONTACT] == 0.0
    assert found["contact [N]"] < 300.0
    assert found[MEASURED] == pytest.approx(found[PLANNED], rel=0.1)
    hold = recording.instances[-1]
    assert (hold.block, hold.end) == (f"HOLDING:{mode}", pytest.approx(recording.duration))
    roles = Roles.of(f"{mode} hands", task.bind(hold.slots))
    held = recording.trajectory.values[-1]
    for hand, face in roles.contacts:
        # At the end, each hand touches its face without penetration, and squeezes hard enough.
        state = recording.at(recording.duration)
        assert np.array_equal(state.values, held)
        assert abs(float(gap_to_face(state, hand, roles.thing, face))) < 0.001
        (force,) = (c.force for c in recording.contacts if hand.name in c.tokens and hold.name in c.instances)
        assert force == pytest.approx(squeeze_for(roles.thing, roles.crew), rel=0.05)


def test_hands_never_go_through_each_other() -> None:
    """Upright hands with a length of 0.16 m and a radius of 0.035 m are above each other or beside each other."""
    task = load_task(PROBLEMS / "lift_four_hands.yaml")
    run_of, _ = run(task)
    hands = task.tokens[:4]
    for number, one in enumerate(hands):
        for other in hands[number + 1 :]:
            offset = run_of.trajectory[one, "position"] - run_of.trajectory[other, "position"]
            above = np.abs(offset[:, 2]) - 0.16
            beside = np.hypot(offset[:, 0], offset[:, 1]) - 0.07
            assert np.maximum(above, beside).min() > 0.01


def test_the_forward_models_expect_what_happens() -> None:
    task = load_task(PROBLEMS / "lift_four_hands.yaml")
    recording, _ = run(task)
    expected = predict(task, hybrid_tamp.plan(task).required())
    thing = task.tokens[-1]
    assert recording.duration == pytest.approx(expected.duration, abs=0.1)
    measured, predicted = (r.trajectory[thing, "position"][-1] for r in (recording, expected))
    assert measured == pytest.approx(predicted, abs=0.003)


@pytest.mark.parametrize(("seed", "hands"), [(10, 4), (261, 2)])
def test_a_box_does_not_turn_in_the_hands(seed: int, hands: int) -> None:
    """With seed 10, the weight is 1.9 times the load of two hands. With seed 261, a box once turned in the hands."""
    _, found = run(random_lifting(seed, hands))
    assert found["tilt [deg]"] < 0.1
    assert found["slip [m]"] < 0.001
    assert found["contact [N]"] < 300.0
