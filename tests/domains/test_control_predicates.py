"""The invariants of a tumble hold in a run: the box turns slowly, and no hand is pressed onto the floor."""

from dataclasses import replace

import numpy as np
import pytest
from hybrid_tamp_domains.rolling_tumbling.control_predicates import CLEAR_OF_FLOOR, ROUGH_ENOUGH, TURNS_SLOWLY
from random_tasks.corners import Corner
from random_tasks.tumbling import random_tumbling

import hybrid_tamp
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import open_backend


def corner(index: int, **properties: float) -> Task:
    """Return the task of a corner of the ranges, with changed properties of the box."""
    task = random_tumbling(index, rng=Corner(index, 5))
    box = task.tokens[-1]
    changed = replace(box, properties={**box.properties, **properties})
    return task.replaced(tokens=(*task.tokens[:-1], changed))


def with_squeeze(plan: TaskPlan, share: float) -> TaskPlan:
    """Return the plan with a smaller squeeze of the hands that lower the box."""
    instances = [
        replace(i, hyperparameters={**i.hyperparameters, "squeeze": share * i.hyperparameters["squeeze"]})
        if i.block == "TIPPING:lower"
        else i
        for i in plan.instances
    ]
    return replace(plan, instances=tuple(instances))


def test_the_margins_are_zero_at_the_bound_of_the_metric_and_at_the_radius_of_the_hand() -> None:
    task = corner(0)
    hand, box = task.tokens[0], task.tokens[-1]
    spinning = task.state.replace({(box.name, "angular_velocity"): (0.0, 2.0, 0.0)})
    assert float(TURNS_SLOWLY.evaluate(spinning, box)) == 0.0
    low = task.state.replace({(hand.name, "position"): (0.5, 0.0, hand["radius"])})
    assert float(CLEAR_OF_FLOOR.evaluate(low, hand)) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("index", range(32))
def test_every_corner_of_the_ranges_is_rough_enough(index: int) -> None:
    task = corner(index)
    assert all(float(ROUGH_ENOUGH.evaluate(task.state, hand, task.tokens[-1])) > 0 for hand in task.tokens[:-1])


def test_a_weak_hand_does_not_make_a_box_too_smooth() -> None:
    task = corner(0, mass=1000.0, friction=1.5)
    assert float(ROUGH_ENOUGH.evaluate(task.state, task.tokens[0], task.tokens[-1])) > 0


def test_a_box_that_hands_squeeze_too_little_falls_and_the_run_says_so() -> None:
    task = corner(4)
    plan = with_squeeze(hybrid_tamp.plan(task).required(), 0.3)
    with open_backend("pybullet") as backend:
        recording = execute(task, plan, backend)
    assert recording.failure is not None
    assert [margin.atom for margin in recording.failure.margins] == [Atom("turns_slowly", ("box 1",))]
    assert "box 1 falls" in recording.failure.reason
    assert np.isfinite(recording.states).all()
