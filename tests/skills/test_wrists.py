"""Hands with a wrist turn to a reference orientation, and stay within the limit of the torque."""

import numpy as np
import pytest

from hybrid_tamp.model.control import CONTROL_PERIOD, Commands
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rotation_vector, quaternion_multiply, rotation_vector
from hybrid_tamp.skills import (
    DAMPING_RATIO,
    StaticEndEffector,
    TurningEndEffector,
    can_turn,
    hand_system,
    keep_orientation,
    turn_wrists,
)

STIFF = {
    "radius": 0.035,
    "length": 0.16,
    "mass": 1.5,
    "maximal_force": 300.0,
    "workspace_lower": (-2.0, -2.0, 0.0),
    "workspace_upper": (2.0, 2.0, 1.5),
}


def turning(inertia: float) -> Token:
    wrist = {"maximal_torque": 5.0, "wrist_inertia": inertia}
    return Token.make("hand", [TurningEndEffector], STIFF | wrist)


def still(elapsed: FloatArray, state: State) -> Commands:
    return {}


def test_only_a_hand_with_a_wrist_is_turned() -> None:
    stiff = Token.make("hand", [StaticEndEffector], STIFF)
    assert (can_turn(stiff), can_turn(turning(0.02))) == (False, True)
    assert turn_wrists(still, {stiff: keep_orientation(np.array([0.0, 0.0, 0.0, 1.0]))}) is still


@pytest.mark.parametrize(("inertia", "stiffness"), [(0.02, 100.0), (0.008, 100.0), (0.002, 0.002 * 150.0**2)])
def test_the_torque_is_that_of_a_damped_spring_whose_frequency_is_limited(inertia: float, stiffness: float) -> None:
    hand = turning(inertia)
    turn, spin = np.array([0.01, -0.02, 0.005]), np.array([0.3, 0.1, -0.2])
    state = State.of((hand,), {("hand", "angular_velocity"): spin})
    policy = turn_wrists(still, {hand: keep_orientation(quaternion_from_rotation_vector(turn))})
    torque = policy(np.asarray(0.0), state)[hand.name, "torque"]
    brake = 2.0 * DAMPING_RATIO * np.sqrt(stiffness * inertia)
    assert np.allclose(torque, stiffness * turn - brake * spin)


@pytest.mark.parametrize("inertia", [0.001, 0.004, 0.02, 0.1])
def test_a_hand_settles_at_its_reference_without_a_limit_cycle(inertia: float) -> None:
    hand = turning(inertia)
    state = State.of((hand,), {("hand", "orientation"): quaternion_from_rotation_vector(np.array([0.3, 0.2, -0.4]))})
    wanted = quaternion_from_rotation_vector(np.array([0.31, 0.18, -0.41]))
    policy, system = turn_wrists(still, {hand: keep_orientation(wanted)}), hand_system({"hand": hand}, state)
    for step in range(240):
        state = system(state, policy(np.asarray(step * CONTROL_PERIOD), state), CONTROL_PERIOD)
    left = rotation_vector(quaternion_multiply(wanted, state[hand, "orientation"] * (-1.0, -1.0, -1.0, 1.0)))
    assert np.linalg.norm(left) < 1e-4
    assert np.linalg.norm(state[hand, "angular_velocity"]) < 1e-3
