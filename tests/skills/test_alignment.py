"""Hands turn to the direction along which they lie at a place, and only if they can turn."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.curves import Curve
from hybrid_tamp.motion.poses import quaternion_conjugate, quaternion_multiply, rotate, rotation_vector
from hybrid_tamp.skills import (
    UP,
    Alignment,
    StaticEndEffector,
    TurningEndEffector,
    near,
    straight_profile,
    turn_along,
)

HAND = {
    "radius": 0.035,
    "length": 0.16,
    "mass": 1.5,
    "maximal_force": 300.0,
    "workspace_lower": (-2.0, -2.0, 0.0),
    "workspace_upper": (2.0, 2.0, 1.5),
}
STIFF = Token.make("stiff", [StaticEndEffector], HAND)
ABLE = Token.make("able", [TurningEndEffector], HAND | {"maximal_torque": 5.0, "wrist_inertia": 0.02})
UPRIGHT = Alignment(lambda state, hand: UP, float(np.radians(3.0)))
_COMPONENT = st.floats(-1.0, 1.0)
ORIENTATIONS = st.tuples(*[_COMPONENT] * 4).filter(lambda q: float(np.linalg.norm(q)) > 0.1)


def leaning(orientation: tuple[float, ...]) -> State:
    unit = np.asarray(orientation) / np.linalg.norm(orientation)
    return State.of((STIFF, ABLE), {(name, "orientation"): unit for name in ("stiff", "able")})


def turned_by(one: FloatArray, other: FloatArray) -> float:
    """Return the angle of the rotation between two orientations [rad]."""
    return float(np.linalg.norm(rotation_vector(quaternion_multiply(other, quaternion_conjugate(one)))))


@given(ORIENTATIONS)
def test_a_hand_that_can_turn_becomes_upright_by_the_smallest_turn(orientation: tuple[float, ...]) -> None:
    state = leaning(orientation)
    wanted = UPRIGHT.orientation(state, ABLE)
    assert abs(rotate(wanted, UP)[2]) == pytest.approx(1.0)
    angle = float(UPRIGHT.angle(state, STIFF))
    assert turned_by(state[ABLE, "orientation"], wanted) == pytest.approx(angle, abs=1e-7)
    assert angle <= np.pi / 2 + 1e-9
    assert np.array_equal(UPRIGHT.orientation(state, STIFF), state[STIFF, "orientation"])
    assert float(UPRIGHT.deviation(state, STIFF)) == angle
    assert float(UPRIGHT.deviation(state, ABLE)) == 0.0


def test_a_hand_that_can_turn_is_at_its_place_only_if_it_has_turned() -> None:
    state = leaning((np.sin(np.radians(2.0)), 0.0, 0.0, np.cos(np.radians(2.0))))  # The hand leans by 4 degrees.
    margin = near(0.03, lambda state, hand: np.zeros(3), UPRIGHT)
    assert float(margin(state, STIFF)) == pytest.approx(0.03)
    assert float(margin(state, ABLE)) == pytest.approx(0.03 * (1.0 - 4.0 / 3.0))
    upright = state.replace({("able", "orientation"): UPRIGHT.orientation(state, ABLE)})
    assert float(margin(upright, ABLE)) == pytest.approx(0.03)


def test_the_angular_velocity_of_a_turn_is_the_rate_of_its_orientation() -> None:
    begun, wanted = np.array([0.0, 0.0, 0.0, 1.0]), np.array([0.6, 0.0, 0.0, 0.8])
    profile = straight_profile()
    turn = turn_along(begun, wanted, lambda elapsed: profile.advance(elapsed, 2.0))
    step = 1e-4
    for time in (0.3, 1.0, 1.7):
        one, other = (turn(np.asarray(time + after))[0] for after in (-step, step))
        rate = rotation_vector(quaternion_multiply(other, quaternion_conjugate(one))) / (2.0 * step)
        assert np.allclose(turn(np.asarray(time))[1], rate, atol=1e-3)
    assert turned_by(turn(np.asarray(3.0))[0], wanted) < 1e-6


def test_a_body_turns_between_the_second_corner_and_the_last_but_one() -> None:
    corners = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.3, 0.4, 0.0], [0.9, 0.4, 0.0]])
    straight, profile, duration = Curve.through(corners), straight_profile(), np.asarray(4.0)
    curve = straight.turning_within(np.asarray(np.pi / 2), len(corners))
    assert np.array_equal(curve.points, straight.points)
    assert float(curve.length) == pytest.approx(float(straight.length) + 0.3 * np.pi / 2)
    for time in np.linspace(0.0, 5.0, 101):
        position, _ = curve.at(time, duration, profile)
        share, _ = curve.turned(time, duration, profile)
        if position[1] < 1e-9:
            assert share == 0.0
        if position[0] > 0.3 + 1e-9 and position[1] > 0.2:
            assert share == 1.0
    # Rows of a batch may have different numbers of corners. The last corner is then repeated.
    padded = np.concatenate([corners, corners[-1:]])
    batch = Curve.through(np.stack([padded, padded])).turning_within(np.array([np.pi / 2, 0.0]), np.array([4, 4]))
    assert batch.length.tolist() == pytest.approx([float(curve.length), float(straight.length)])
