"""Runs of tumbling in PyBullet, with checks of the law, measures and contacts (see also scripts/campaign)."""

from pathlib import Path

import pytest
from hybrid_tamp_domains.rolling_tumbling.metrics import CONTROLLED
from random_tasks.corners import Corner
from random_tasks.tumbling import random_tumbling

import hybrid_tamp
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.model.law import check_law
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.questions.changes import without_token
from hybrid_tamp.report.measures import CONTACT, MEASURED, PLANNED, run_measures
from hybrid_tamp.taskfile.loader import load_task

PROBLEMS = Path(__file__).parents[2] / "problems"


def measured(seed: int, hands: int, rng: Corner | None = None) -> dict[str, float]:
    """Plan and run a random task, check the law and that tumbles are controlled, and return all measures."""
    task = random_tumbling(seed, hands=hands, rng=rng)
    plan = hybrid_tamp.plan(task).required()
    with open_backend("pybullet") as physics:
        recording = execute(task, plan, physics)
    assert recording.success
    assert not check_law(task, recording.plan, recording.at)
    assert task.domain.metrics is not None
    found = dict(task.domain.metrics(task, recording))
    for name, (low, high) in CONTROLLED.items():
        [value] = [value for (_, measure), value in found.items() if measure == name]
        assert low <= value <= high, name
    return {measure: value for (_, measure), value in found.items()} | dict(run_measures(plan, recording))


def test_four_hands_are_a_fifth_faster_than_two_and_leave_the_box_in_peace() -> None:
    two, four = measured(0, 2), measured(0, 4)
    for duration in (PLANNED, MEASURED):
        assert four[duration] < 0.8 * two[duration]
    for run in (two, four):
        assert run[CONTACT] < 5.0
        assert run[PLANNED] == pytest.approx(run[MEASURED], rel=0.1)


def test_a_box_whose_edge_slides_is_tipped_all_the_same() -> None:
    """Seed 25 gives nearly a cube with a friction of 0.4. The edge slides by 3 cm, so the hands turn further."""
    assert measured(25, 2)[CONTACT] < 5.0


def test_two_one_handed_robots_tumble_a_box_together() -> None:
    task = load_task(PROBLEMS / "tumble_two_robots.yaml")
    plan = hybrid_tamp.plan(task).required()
    with open_backend("pybullet") as physics:
        recording = execute(task, plan, physics)
    assert recording.success
    assert not check_law(task, recording.plan, recording.at)
    assert run_measures(plan, recording)[CONTACT] < 5.0
    for agent in task.agents:
        alone = without_token(task, task.token_by_name[task.agents[agent][0]])
        assert hybrid_tamp.plan(alone, trials=0).status == "unsolvable"


@pytest.mark.parametrize("corner", [0, 4, 12])
def test_a_box_at_a_corner_of_the_ranges_is_controlled(corner: int) -> None:
    """With a squeeze of half the weight, box 0 slides, box 4 drops at 2.9 rad/s and box 12 presses a hand down."""
    assert measured(corner, 2, Corner(corner, 5))[CONTACT] < 5.0
