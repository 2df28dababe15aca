"""Hands that rest where another hand must go give way to it."""

import numpy as np
import pytest
from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from hybrid_tamp_domains.rolling_tumbling.push import ROLL
from random_tasks.rolling import random_rolling

import hybrid_tamp
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import MidLevel, Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.skills import StaticEndEffector


def blocked(room: float = 0.28) -> Task:
    """Return a task in which a hand rests just where another hand must go to roll the drum.

    The workspace of the resting hand is too small for the roll, and ends at a distance of `room` [m] around its place.
    """
    task = random_rolling(0)
    hand, drum, goal = task.tokens
    place = ROLL.standby(task.bind({"hand": "hand", "object": "cylinder", "region": "goal"}), task.state)
    own = {**hand.properties, "workspace_lower": tuple(place - room), "workspace_upper": tuple(place + room)}
    tokens = (hand, Token.make("other hand", [StaticEndEffector], own), drum, goal)
    given = {(each.name, key): task.state[each, key] for each in task.tokens for key in ("position", "orientation")}
    return task.replaced(tokens=tokens, state=State.of(tokens, given | {("other hand", "position"): place}))


@pytest.fixture(scope="module")
def outcome() -> PlanOutcome:
    task = blocked()
    return hybrid_tamp.plan(task.replaced(midlevel=MidLevel(evaluations=2)), optimise=True)


def test_a_resting_hand_withdraws_before_the_movement_that_would_hit_it(outcome: PlanOutcome) -> None:
    task, plan = blocked(), outcome.required()
    (withdrawal,) = (each for each in plan.instances if each.block == "WITHDRAWING")
    reach = next(each for each in plan.instances if each.block == "REACHING:behind")
    assert withdrawal.slots == {"hand": "other hand"}
    assert (withdrawal.name, reach.name) in plan.order
    assert withdrawal.reached is not None
    assert withdrawal.reached <= reach.start + 1e-6
    assert not check_law(task, plan)
    assert np.allclose(withdrawal.path[0], task.state["other hand", "position"])
    assert any("withdrawing" in action.name for action in plan.actions)
    assert "WITHDRAWING" not in outcome.network.blocks


def test_the_hand_has_given_way_in_a_run(outcome: PlanOutcome) -> None:
    task = blocked()
    with open_backend("pybullet") as physics:
        recording = execute(task, outcome.required(), physics)
    assert recording.success
    assert not check_law(task, recording.plan, recording.at)
    assert not [each for each in recording.contacts if {"hand", "other hand"} <= set(each.tokens)]


def test_a_hand_without_room_does_not_give_way() -> None:
    found = hybrid_tamp.plan(blocked(room=0.05))
    assert found.plan is None
    assert "hits other hand" in str(found.error)


def test_the_task_planner_never_uses_the_block() -> None:
    plan = hybrid_tamp.plan(random_rolling(0)).required()
    assert "WITHDRAWING" in DOMAIN.block_by_name
    assert all(each.block != "WITHDRAWING" for each in plan.instances)
