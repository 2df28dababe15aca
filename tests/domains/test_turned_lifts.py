"""Hands that can turn lift boxes from any orientation. Hands that cannot turn must be upright."""

from dataclasses import replace

import numpy as np
import pytest
from hybrid_tamp_domains.joint_lifting.load import load, squeeze_for, wrist_moment
from hybrid_tamp_domains.joint_lifting.metrics import CONTROLLED
from hybrid_tamp_domains.joint_lifting.places import contact_length, height_of_hand
from hybrid_tamp_domains.joint_lifting.predicates import AT_PLACE, FITS, UPRIGHT
from random_tasks.lifting import random_lifting
from random_tasks.turned import random_lift_around

import hybrid_tamp
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.model.expectation import expect
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.task import MidLevel, Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.questions.explain.no_plan import explain
from hybrid_tamp.report.measures import CONTACT, run_measures
from hybrid_tamp.skills import TurningEndEffector, z_axis

TASK = random_lift_around(3, upright=False)


def leaning(angle: float) -> Task:
    """Return a task for two hands that cannot turn, of which one leans by an angle [degrees]."""
    task = random_lifting(0)
    lean = quaternion_from_rpy(np.array([np.radians(angle), 0.0, 0.0]))
    return task.replaced(state=task.state.replace({("hand 1", "orientation"): lean}))


def crate(half_height: float) -> Token:
    """Return the box of the task with another half height [m]."""
    thing = TASK.token_by_name["box"]
    half_x, half_y, _ = thing["half_extents"]
    own = {**thing.properties, "half_extents": (half_x, half_y, half_height)}
    return Token.make("box", list(thing.classes), own)


@pytest.mark.parametrize("angle", [5.0, 90.0])
def test_the_refusal_says_that_the_hand_cannot_turn_and_states_the_angle(angle: float) -> None:
    reasons = [each for each in explain(leaning(angle)) if each.atom and each.atom.predicate == "upright"]
    assert reasons
    for reason in reasons:
        assert "hand 1 cannot turn and is not upright" in reason.message
        assert f"({angle:g} degrees, but at most 3 degrees are possible; a limit of the" in reason.message


def test_a_hand_that_can_turn_is_at_its_place_only_upright() -> None:
    hand, box = TASK.token_by_name["hand 1"], TASK.token_by_name["box"]
    assert float(UPRIGHT.evaluate(TASK.state, hand)) > 0.0
    block = TASK.domain.block_by_name["REACHING:place"]
    binding = TASK.bind({"hand": "hand 1", "object": "box", "place": "left"})
    reached = expect(block, binding, TASK.state, block.initial_values(binding, TASK.state)).end
    assert reached is not None
    assert abs(z_axis(reached, hand)[2]) > np.cos(np.radians(0.1))
    assert float(AT_PLACE.evaluate(reached, hand, box, "left")) > 0.0
    leans = reached.replace({("hand 1", "orientation"): TASK.state["hand 1", "orientation"]})
    assert float(AT_PLACE.evaluate(leans, hand, box, "left")) < 0.0


@pytest.mark.parametrize("half_height", [0.03, 0.06, 0.09, 0.13, 0.2])
def test_the_centre_of_the_squeeze_is_on_the_face(half_height: float) -> None:
    hand, box = TASK.token_by_name["hand 1"], crate(half_height)
    stiff = random_lifting(3).token_by_name["hand 1"]
    above = height_of_hand(hand, box)
    assert above <= height_of_hand(stiff, box)
    assert above - 0.08 >= 0.0099 - half_height  # The hand is clear of the floor.
    assert contact_length(hand, box) >= contact_length(stiff, box)
    lever = above - half_height
    expected = load(box, "two hands") * 0.035 + lever * squeeze_for(box, "two hands")
    assert wrist_moment(hand, box, "two hands") == pytest.approx(max(expected, 0.0))
    assert (wrist_moment(hand, box, "two hands") > 0.0) == (half_height < 0.06)


def test_a_wrist_that_is_too_weak_for_a_low_box_is_named_with_its_moment() -> None:
    hand, box = TASK.token_by_name["hand 1"], crate(0.03)
    needed = wrist_moment(hand, box, "two hands")
    for torque, fits in ((0.9 * needed, False), (1.1 * needed, True)):
        weak = Token.make("hand 1", [TurningEndEffector], {**hand.properties, "maximal_torque": torque})
        task = TASK.replaced(tokens=(weak, TASK.tokens[1], box))
        assert (float(FITS.evaluate(task.state, weak, box, "left")) >= 0.0) == fits
        assert FITS.detail is not None
        if not fits:
            said = f"its wrist would have to bear {needed:.3g} N m, but it bears at most {torque:.3g} N m"
            assert FITS.detail(task.state, weak, box, "left") == said


def test_hands_lift_a_box_from_any_orientation_on_one_side() -> None:
    task = TASK.replaced(midlevel=replace(MidLevel(), evaluations=16))
    plan = hybrid_tamp.plan(task, optimise=True).required()
    with open_backend("pybullet") as physics:
        recording = execute(task, plan, physics)
    assert recording.success
    assert not check_law(task, recording.plan, recording.at)
    assert task.domain.metrics is not None
    for (_, name), value in task.domain.metrics(task, recording).items():
        if name in CONTROLLED:
            low, high = CONTROLLED[name]
            assert low <= value <= high, name
    assert dict(run_measures(plan, recording))[CONTACT] < 5.0
