"""Tests of candidates in physics, which run one after the other or in several processes."""

import numpy as np
import pytest
from hammer_figures import GRASP, figure_plan, figure_task
from midlevel.plans import reach_and_roll
from scenes import rolling_task

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.midlevel.measured import measure_run
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.refined import GOAL
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.planning.physics_rollouts import PhysicsRollouts

DISTANCE = ("ROLLING-1", "distance")


def test_two_processes_come_to_the_bits_of_one() -> None:
    """The task with a hammer is sent to the processes with its domain, whose functions are closures."""
    task, plan = figure_task("strike", 0.5), figure_plan("strike")
    grasps = {GRASP: np.array([0.02, 0.07, 0.12])}
    one, two = (PhysicsRollouts(task, plan, "pybullet", n)(grasps, 3, until="GRASPING-1") for n in (1, 2))
    assert np.array_equal(one.final.values, two.final.values)
    assert np.array_equal(one.violation, two.violation)
    assert one.figures["GRASPING-1", "contact"] == pytest.approx([5 / 6, 1.0, 1.0], abs=1e-3)
    assert np.array_equal(one.figures["GRASPING-1", "contact"], two.figures["GRASPING-1", "contact"])
    assert not any(condition.where == GOAL for condition in one.conditions)


@pytest.mark.parametrize("processes", [1, 2])
def test_every_process_checks_the_deadline(processes: int) -> None:
    task = rolling_task()
    late = PhysicsRollouts(task, reach_and_roll(task), "analytic", processes, Deadline.after(0.0))
    with pytest.raises(LimitReached, match="time limit of 0 s") as caught:
        late({DISTANCE: np.array([0.7, 0.69])}, 2)
    assert caught.value.limit == "time"


def test_a_population_is_its_candidates() -> None:
    task = rolling_task()
    plan = reach_and_roll(task)
    together = PhysicsRollouts(task, plan, "analytic")({DISTANCE: np.array([0.7, 0.69])}, 2)
    for candidate, value in enumerate((0.7, 0.69)):
        alone = PhysicsRollouts(task, plan, "analytic")({DISTANCE: np.array([value])}, 1)
        assert together.violation[candidate] == alone.violation[0]
        assert np.array_equal(together.final.values[candidate], alone.final.values[0])
    with open_backend("analytic") as backend:
        recording = execute(task, plan, backend)
    assert together.violation[0] == measure_run(task, recording).violation[0] == 0.0


def test_a_run_that_fails_is_the_worst_and_names_its_instance() -> None:
    task = rolling_task()
    rollout = PhysicsRollouts(task, reach_and_roll(task), "analytic")({DISTANCE: np.array([0.7, 0.3])}, 2)
    assert rollout.violation[0] == 0.0
    assert rollout.violation[1] == np.inf
    assert rollout.failed["ROLLING-1"].tolist() == [False, True]
    worst = rollout.worst(1)
    assert worst is not None
    assert (worst.where, worst.atom.text) == ("ROLLING-1", "inside(drum 0, region 0)")
