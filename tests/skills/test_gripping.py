"""The rigid body of a hand and its object agrees with closed forms, and grippers place objects where they should."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import hybrid_tamp
from hybrid_tamp.model.grasp import CAPTURE
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.motion.poses import quaternion_from_rpy, rotate
from hybrid_tamp.skills import (
    UP,
    HeldBody,
    Load,
    attitude,
    beside_handle,
    handle_length,
    in_body,
    lean,
    on_handle,
    point,
    pose_held,
    side,
    stand_at,
    standing_height,
    stands_on,
    yaw,
)

TASK = hybrid_tamp.load_task(Path(__file__).resolve().parents[2] / "examples" / "placing" / "task.yaml")
HAND, MUG, SHELF = (TASK.token_by_name[name] for name in ("hand", "mug", "shelf"))
STEP = 1.0 / 240


def held(location: float, direction: float = 0.3, angle: float = 0.0) -> State:
    """Return the state in which the hand holds the mug at a distance from ``handle_to``."""
    grip = point(TASK.state, MUG, on_handle(MUG, location))
    state = TASK.state.replace({("hand", "position"): grip, ("hand", "aperture"): MUG["handle_width"]})
    return state.replace(pose_held(state, HAND, MUG, np.array([0.1, 0.2, 0.9]), attitude(direction, angle)))


def test_a_hand_at_rest_bears_the_weight_of_the_object_and_its_torque() -> None:
    state = held(0.02)
    commands = HeldBody(HAND, MUG).wrench(state, np.zeros(3), np.zeros(3))
    weight = np.array([0.0, 0.0, -GRAVITY * MUG["mass"]])
    arm = state[MUG, "position"] - state[HAND, "position"]
    assert commands["hand", "force"].tolist() == pytest.approx((-weight).tolist())
    assert commands["hand", "torque"].tolist() == pytest.approx((-np.cross(arm, weight)).tolist())


@pytest.mark.parametrize("seed", range(5))
def test_the_commands_for_an_acceleration_accelerate_the_body_by_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    state = held(rng.uniform(0.0, 0.07), rng.uniform(-3.0, 3.0), rng.uniform(-1.0, 1.0))
    state = state.replace({(name, "angular_velocity"): rng.uniform(-1.0, 1.0, 3) for name in ("mug",)})
    body, moving, turning = HeldBody(HAND, MUG), rng.uniform(-3.0, 3.0, 3), rng.uniform(-9.0, 9.0, 3)
    arm = state[MUG, "position"] - state[HAND, "position"]
    turning -= arm * (turning @ arm) / (arm @ arm)  # The arm has no moment of inertia about itself.
    velocity, spin = body.accelerated(state, body.wrench(state, moving, turning), STEP)
    assert ((velocity - state[HAND, "velocity"]) / STEP).tolist() == pytest.approx(moving.tolist(), abs=1e-6)
    assert ((spin - state[MUG, "angular_velocity"]) / STEP).tolist() == pytest.approx(turning.tolist(), abs=1e-6)


@pytest.mark.parametrize(("pull", "lost"), [(0.95, False), (1.05, True)])
def test_a_pull_beyond_the_friction_of_both_pads_loses_the_object(pull: float, lost: bool) -> None:
    state, body = held(0.03), HeldBody(HAND, MUG)
    friction = 2.0 * 0.5 * HAND["maximal_grip"]
    force = np.array([0.0, 0.0, GRAVITY * MUG["mass"] - pull * friction])
    load = Load(force, state[HAND, "position"])
    still = body.placed(state, np.zeros(3), np.zeros(3), STEP)
    # The arm of the weight also turns the handle, so the load is compared at the hand's centre.
    ratio = body.grip_load(state.replace({("mug", "position"): state[HAND, "position"]}), still, STEP, load)
    assert (float(ratio) > 1.0) == lost
    after = state.replace(body.loosened(still, state, ratio))
    assert (float(TASK.domain.predicate_by_name["held"].margin(after, MUG, HAND)) < 0.0) == lost


@pytest.mark.parametrize("location", [0.0, 0.03, 0.07])
def test_an_object_stands_at_the_middle_of_the_place_with_its_yaw_whatever_the_grasp(location: float) -> None:
    state = held(location, 1.1, 0.4)
    place, direction, angle = stand_at("shelf")({"hand": HAND, "object": MUG, "shelf": SHELF}, state)
    after = state.replace(pose_held(state, HAND, MUG, place, attitude(direction, angle)))
    assert after[MUG, "position"].tolist() == pytest.approx([0.7, 0.1, 0.7 + standing_height(MUG)])
    assert (float(lean(after, MUG)), float(yaw(after, MUG))) == pytest.approx((0.0, 1.1))
    assert float(stands_on(MUG.classes[0]).margin(after, MUG, SHELF)) == pytest.approx(0.005)


@pytest.mark.parametrize(
    ("aside", "above", "angle", "stands"),
    [(0.0, 0.0, 0.0, True), (0.16, 0.0, 0.0, False), (0.0, 0.02, 0.0, False), (0.0, 0.0, 0.1, False)],
)
def test_an_object_stands_on_a_surface_if_it_is_upright_above_it_and_touches_it(
    aside: float, above: float, angle: float, stands: bool
) -> None:
    at = {("mug", "position"): (0.7, 0.1 + aside, 0.7 + standing_height(MUG) + above)}
    state = TASK.state.replace(at | {("mug", "orientation"): attitude(0.2, angle)})
    margin = TASK.domain.predicate_by_name["stands_on"].margin(state, MUG, SHELF)
    assert (float(margin) >= 0.0) == stands


def test_a_held_object_goes_directly_from_block_to_block() -> None:
    edges = TASK.domain.network.edges
    assert (("GRASPING", "object"), ("PLACING", "object")) in edges
    assert (("PLACING", "hand"), ("RELEASING", "hand")) in edges
    assert not any(one[0] in ("GRASPING", "PLACING") and other[0] == "RESTING" for one, other in edges)
    assert (("RELEASING", "hand"), ("RESTING", "token")) in edges


def test_a_place_out_of_reach_is_refused_before_the_search() -> None:
    far = replace(TASK, state=TASK.state.replace({("shelf", "position"): (1.9, 0.1, 0.35)}))
    outcome = hybrid_tamp.plan(far)
    assert outcome.failure is not None
    assert "hand cannot bring mug to its goal without leaving the workspace of the hand" in str(outcome.failure.message)


@pytest.mark.parametrize(("low", "high", "failing"), [(0.01, 0.03, True), (0.01, 0.05, False)])
def test_a_hand_grasps_a_low_handle_high_enough_or_not_at_all(low: float, high: float, failing: bool) -> None:
    up = standing_height(MUG) - low
    ends = {"handle_to": (up, 0.0, 0.0673), "handle_from": (up - (high - low), 0.0, 0.0673)}
    mug = Token.make("mug", list(MUG.classes), {**MUG.properties, **ends}, MUG.shape)
    block, binding = TASK.domain.block_by_name["GRASPING"], {"hand": HAND, "object": mug, "surface": SHELF}
    margin = float(TASK.domain.predicate_by_name["high_enough"].margin(TASK.state, HAND, mug))
    assert (margin < 0.0) == failing
    assert margin == pytest.approx(high - HAND["radius"] - 0.005, abs=1e-9)
    chosen = float(block.initial_values(binding, TASK.state)["grasp_location"])
    assert low + chosen == pytest.approx(min(high, HAND["radius"] + 0.005), abs=1e-9)


def beside(y: float) -> float:
    """Return how far aside a hand waits that is at ``y`` in the body frame of the mug [m]."""
    middle = on_handle(MUG, handle_length(MUG) / 2.0)
    state = TASK.state.replace({("hand", "position"): point(TASK.state, MUG, middle + np.array([0.0, y, 0.0]))})
    return float(in_body(state, MUG, beside_handle(state, HAND, MUG))[1])


def test_a_hand_waits_on_its_side_of_the_handle_and_noise_decides_nothing() -> None:
    assert beside(-0.2) == pytest.approx(-beside(0.2))
    assert beside(0.2) > 0.0
    # A hand that holds the handle is off its middle by the error of the servo, in physics not as in the forward model.
    assert beside(-CAPTURE) == beside(-1e-4) == beside(1e-4) == beside(0.2)
    # A hand that waits beside the handle stays there.
    assert beside(beside(-0.2) + 0.02) == beside(-0.2)


@pytest.mark.parametrize("degrees", [-170.0, -60.0, 20.0, 45.0])
def test_a_hand_that_arrives_at_a_handle_lies_across_it(degrees: float) -> None:
    turned = quaternion_from_rpy((np.pi / 2, 0.0, np.radians(degrees)))
    start = TASK.state.replace({("hand", "orientation"): turned})
    binding = TASK.bind({"hand": "hand", "object": "mug", "surface": "table"})
    after = TASK.domain.block_by_name["REACHING:handle"].outcome(binding, start)
    assert abs(float(side(after, MUG) @ rotate(after[HAND, "orientation"], UP))) == pytest.approx(1.0)
    at_handle = TASK.domain.predicate_by_name["at_handle"]
    assert float(at_handle.margin(after, HAND, MUG)) > 0.0
    assert float(at_handle.margin(after.replace({("hand", "orientation"): turned}), HAND, MUG)) < 0.0
