"""The limits of a grip in PyBullet, and how far the handle slides, against closed forms."""

import numpy as np
import pytest
from workbench import HAMMER, MASS, MOMENT, UP, WIDTH, WRIST, Tool, grasp_point, held

from hybrid_tamp.geometry.shapes import Box
from hybrid_tamp.model.grasp import grip_limits
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, quaternion_multiply, rotate, rotation_vector
from hybrid_tamp.physics.bullet.backend import BulletBackend

GRIP, FRICTION, PAD = 20.0, 0.5, 0.06
"""Force of a finger [N], friction coefficient of the pads, and length of the pads [m]."""
LIMITS = np.array(
    [
        2 * FRICTION * GRIP,
        2 * FRICTION * GRIP,
        2 * GRIP,
        FRICTION * GRIP * WIDTH,
        GRIP * PAD,
        2 * FRICTION * GRIP * PAD / 4,
    ]
)
"""What the grip bears along the handle, across it and along the closing direction, and about these axes [N, N m]."""
MOMENTS, LIGHT = np.array([0.05, 0.2, 0.22]), np.array([0.0004, MOMENT, 0.0022])
"""Moments of inertia of a hammer that a torque on the grip hardly turns, and of the usual hammer [kg m^2]."""
TURN = np.array([0.0, 0.0, 0.0, 1.0])


def loaded(load: FloatArray, seconds: float = 0.2) -> State:
    """Load the grip of a hand at the hammer's centre with a wrench ``(6,)`` on the hammer, and return the last state.

    Gravity loads the grip with a force, which a force on the hand balances. A torque on the hand turns both bodies, and
    loads the grip with the torque that turns the hammer.
    """
    heavy = Token.make("hammer", [Tool], {"mass": MASS, "inertia": tuple(MOMENTS.tolist())}, HAMMER)
    task = held(0.0, TURN, hammer=heavy)
    with BulletBackend(tuple(load[:3] / MASS)) as backend:
        state = backend.reset(task, task.state)
        for _ in range(round(seconds / backend.timestep)):
            torque = load[3:] * (MOMENTS + WRIST) / MOMENTS
            force = 3000 * (UP - state["hand", "position"]) - 110 * state["hand", "velocity"] - load[:3]
            commands = {("hand", "force"): force, ("hand", "torque"): torque, ("hand", "grip"): np.array([GRIP])}
            state = backend.step(commands)
    return state


def slip(state: State) -> float:
    """Return how far the handle has moved in the hand, as a length of a point at the end of the pads [m]."""
    turn = quaternion_multiply(quaternion_conjugate(state["hammer", "orientation"]), state["hand", "orientation"])
    return float(np.linalg.norm(grasp_point(state)) + np.linalg.norm(rotation_vector(turn)) * PAD / 2)


def test_the_limits_are_those_of_two_pads() -> None:
    hand, hammer = held(0.0, TURN).tokens[:2]
    assert grip_limits(hand, hammer, GRIP) == pytest.approx(LIMITS)


DIRECTIONS = {
    "along": (1, 0, 0, 0, 0, 0),
    "across": (0, 1, 0, 0, 0, 0),
    "pushed on a finger": (0, 0, 1, 0, 0, 0),
    "about the handle": (0, 0, 0, 1, 0, 0),
    "about the axis across": (0, 0, 0, 0, 1, 0),
    "about the closing direction": (0, 0, 0, 0, 0, 1),
    "along and across": (0.6, 0.8, 0, 0, 0, 0),
    "along, with a torque": (0.8, 0, 0, 0, 0, 0.6),
    "across, with a torque": (0, -0.6, 0, 0, 0, 0.8),
    "along, with torques": (0.6, 0, 0, 0.48, 0, 0.64),
    "along while pushed on a finger": (1.0, 0, 0.9, 0, 0, 0),
}


@pytest.mark.parametrize("name", DIRECTIONS)
def test_a_grip_holds_below_the_limit_surface_and_slides_above_it(name: str) -> None:
    load = np.array(DIRECTIONS[name]) * LIMITS
    elastic, slid = (slip(loaded(share * load)) for share in (0.97, 1.03))
    again = slip(loaded(0.97 * load, 0.4))
    assert elastic < 1.5e-3
    assert again < elastic + 2e-4, "a grip below its limit must not creep"
    assert slid > elastic + 2e-3


@pytest.mark.parametrize("speed", [(0.28, 0.0, 0.0), (0.0, -0.28, 0.0), (0.2, 0.2, 0.0)])
def test_a_blow_slides_as_far_as_coulomb_says(speed: tuple[float, float, float]) -> None:
    """A free hand and a hammer with a relative speed v come to rest after v^2 m / (2 F), m the reduced mass."""
    task, gentle = held(0.0, TURN), 2.0
    start = task.state.replace({("hammer", "velocity"): np.asarray(speed)})
    with BulletBackend((0.0, 0.0, 0.0)) as backend:
        state = backend.reset(task, start)
        for _ in range(60):
            state = backend.step({("hand", "grip"): np.array([gentle])})
    reduced = MASS * 1.0 / (MASS + 1.0)
    wanted = np.dot(speed, speed) * reduced / (2 * 2 * FRICTION * gentle)
    assert np.linalg.norm(grasp_point(state)) == pytest.approx(wanted, rel=0.03)
    assert np.linalg.norm(state["hand", "velocity"] - state["hammer", "velocity"]) < 1e-3
    assert state["hand", "velocity"] == pytest.approx(np.array(speed) * MASS / (MASS + 1.0), rel=1e-3)


def test_a_sliding_grip_is_restored_bit_for_bit() -> None:
    """A tool of one solid is restored by Bullet's own state, and a compound by a repetition of all commands."""
    solid = Token.make("hammer", [Tool], {"mass": MASS}, Box(kind="box", half_extents=(0.1, 0.012, 0.012)))
    task = held(0.08, TURN, hammer=solid)

    def rows(backend: BulletBackend, first: int, count: int) -> list[bytes]:
        found = []
        for step in range(first, first + count):
            force, torque = np.array([3.0, 1.0, 6.0 + 20 * np.sin(step)]), np.array([0.3, -0.6, 0.3 * np.cos(step)])
            commands = {("hand", "force"): force, ("hand", "torque"): torque, ("hand", "grip"): np.array([6.0])}
            found.append(backend.step(commands).values.tobytes())
        return found

    with BulletBackend() as backend:
        backend.reset(task, task.state)
        rows(backend, 0, 30)
        assert abs(grasp_point(backend.step({("hand", "grip"): np.array([6.0])}))[1]) > 1e-3
        with backend.snapshot() as go_back:
            once = rows(backend, 30, 40)
            go_back()
            assert rows(backend, 30, 40) == once


def test_a_grip_keeps_momentum_and_angular_momentum() -> None:
    """A blow beside the hand: both bodies together have what the hammer had."""
    task = held(0.1, TURN)
    velocity, spin = np.array([0.3, 0.4, -0.5]), np.array([0.5, -1.0, 2.0])
    start = task.state.replace({("hammer", "velocity"): velocity, ("hammer", "angular_velocity"): spin})
    with BulletBackend((0.0, 0.0, 0.0)) as backend:
        before = backend.reset(task, start)
        after = before
        for _ in range(10):
            after = backend.step({("hand", "grip"): np.array([GRIP])})
    assert momentum(after) == pytest.approx(momentum(before), rel=2e-3, abs=2e-4)


def momentum(state: State) -> FloatArray:
    """Return momentum and angular momentum about the origin of hand and hammer ``(6,)``."""
    hand, hammer = (state[name, "velocity"] * mass for name, mass in (("hand", 1.0), ("hammer", MASS)))
    about = np.cross(state["hand", "position"], hand) + np.cross(state["hammer", "position"], hammer)
    own = WRIST * state["hand", "angular_velocity"] + spin_of(state)
    return np.concatenate([hand + hammer, about + own])


def spin_of(state: State) -> FloatArray:
    """Return the hammer's own angular momentum ``(3,)`` [kg m^2/s]."""
    turn = state["hammer", "orientation"]
    return rotate(turn, LIGHT * rotate(quaternion_conjugate(turn), state["hammer", "angular_velocity"]))
