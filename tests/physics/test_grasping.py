"""Comparison of a hand that holds a hammer with closed forms. The hand has a wrist and two virtual fingers."""

import numpy as np
import pytest
from workbench import (
    FIRM,
    FORWARD,
    HANDLE_UP,
    LEFT,
    MASS,
    MOMENT,
    ON_ITS_HEAD,
    OPENED,
    UP,
    WEAK,
    WIDTH,
    WRIST,
    Clumsy,
    Hand,
    Stiff,
    Thing,
    ball,
    block,
    grasp_point,
    held,
    run,
    scene,
    upright,
)

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.commands import CommandError
from hybrid_tamp.model.control import Commands
from hybrid_tamp.model.grasp import FINGER_SPEED
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.motion.poses import (
    quaternion_conjugate,
    quaternion_from_rpy,
    quaternion_multiply,
    rotate,
    rotation_vector,
)
from hybrid_tamp.physics.bullet.backend import BulletBackend


def test_a_torque_turns_a_hand_about_the_axes_of_the_world() -> None:
    turn = quaternion_from_rpy([0.4, 0.5, 0.6])
    task = scene({("hand", "orientation"): turn, ("hand", "position"): UP}, hand=ball("hand", Hand, mass=1.0))
    torque = np.array([0.01, -0.02, 0.03])
    state = run(task, 0.5, lambda time, now: {("hand", "torque"): torque})[-1]
    assert state["hand", "angular_velocity"] == pytest.approx(torque / WRIST * 0.5, rel=1e-6)
    assert state["hand", "position"] == pytest.approx(UP, abs=1e-9)


def test_a_force_on_a_hand_that_turns_does_not_twist_it() -> None:
    task = scene({("hand", "position"): UP, ("hand", "velocity"): (0.0, 2.0, 0.0)}, hand=ball("hand", Hand, mass=1.0))
    state = run(task, 0.5, lambda time, now: {("hand", "force"): 20 * FORWARD})[-1]
    assert np.linalg.norm(state["hand", "angular_velocity"]) < 1e-6


@pytest.mark.parametrize("grasp", [0.03, 0.08, 0.12, 0.15])
def test_holding_a_hammer_level_takes_its_weight_times_the_lever(grasp: float) -> None:
    task = held(grasp, np.array([0.0, 0.0, 0.0, 1.0]))
    wanted: list[float] = []

    def policy(time: float, now: State) -> Commands:
        commands = upright(now, UP, FIRM)
        wanted.append(-commands["hand", "torque"][1])
        return commands

    states = run(task, 5.0, policy)
    lever = (states[-1]["hammer", "position"] - states[-1]["hand", "position"])[0]
    assert np.mean(wanted[-100:]) == pytest.approx(MASS * GRAVITY * lever, rel=1e-4)
    assert lever == pytest.approx(grasp, rel=1e-3)
    drift = [np.linalg.norm(grasp_point(state) - grasp_point(states[240])) for state in states[240:]]
    assert max(drift) < 1e-6


def strike(grasp: float, grip: float, torque: float = 4.0, angle: float = np.pi / 2) -> tuple[list[State], float]:
    """Swing a raised hammer about a fixed wrist by a constant torque, and return the states and the angle."""
    task = held(grasp, HANDLE_UP)
    inertia = MOMENT + MASS * grasp**2 + WRIST
    turned: list[float] = [0.0]

    def policy(time: float, now: State) -> Commands:
        lever, rate = grasp * rotate(now["hammer", "orientation"], FORWARD), now["hammer", "angular_velocity"]
        turned.append(2 * float(np.arctan2(now["hand", "orientation"][1], now["hand", "orientation"][3])))
        swings = time > 0.1 and turned[-1] < angle
        effort = torque * LEFT if swings else np.zeros(3)
        pull = np.cross(effort / inertia, lever) + np.cross(rate, np.cross(rate, lever)) + GRAVITY * UP
        force = 20000 * (UP - now["hand", "position"]) - 250 * now["hand", "velocity"] + MASS * pull
        weight = np.cross(lever, -MASS * GRAVITY * UP)
        return {("hand", "force"): force, ("hand", "torque"): effort - weight, ("hand", "grip"): np.array([grip])}

    states = run(task, 0.35, policy)
    end = next((index for index, turn in enumerate(turned[1:]) if turn >= angle), len(states) - 1)
    return states[: end + 1], turned[end + 1]


@pytest.mark.parametrize("grasp", [0.04, 0.12])
def test_a_firm_grasp_bears_a_blow_with_the_speed_that_the_work_gives(grasp: float) -> None:
    states, angle = strike(grasp, FIRM)
    end = states[-1]
    tip = rotate(end["hammer", "orientation"], 0.025 * FORWARD)
    speed = np.linalg.norm(end["hammer", "velocity"] + np.cross(end["hammer", "angular_velocity"], tip))
    expected = np.sqrt(2 * 4.0 * angle / (MOMENT + MASS * grasp**2 + WRIST)) * (grasp + 0.025)
    assert speed == pytest.approx(expected, rel=0.01)
    assert max(np.linalg.norm(state["hand", "position"] - UP) for state in states) < 1e-3
    assert max(np.linalg.norm(grasp_point(state) - [-grasp, 0.0, 0.0]) for state in states) < 1e-3


def test_a_weak_grasp_turns_in_the_hand_and_slides() -> None:
    """A grip of 5 N bears 0.3 N m and 5 N, and a strike takes 4 N m and the weight takes 5.9 N."""
    states, _ = strike(0.12, WEAK)
    turn = quaternion_multiply(
        quaternion_conjugate(states[-1]["hammer", "orientation"]), states[-1]["hand", "orientation"]
    )
    before = quaternion_conjugate(HANDLE_UP)
    assert np.linalg.norm(rotation_vector(quaternion_multiply(turn, quaternion_conjugate(before)))) > 1.0
    assert abs(grasp_point(states[-1])[0] + 0.12) > 0.01


@pytest.mark.parametrize(("share", "slips"), [(0.95, True), (1.05, False)])
def test_a_grasp_bears_as_much_as_the_grip(share: float, slips: bool) -> None:
    """The hammer hangs head down, so that its weight pulls along the handle."""
    grip = share * MASS * GRAVITY
    states = run(held(0.1, ON_ITS_HEAD), 0.5, lambda time, now: upright(now, UP, grip))
    assert (grasp_point(states[-1])[0] < -0.11) == slips


def test_what_has_slipped_stays_where_it_has_slipped_to() -> None:
    weight = MASS * GRAVITY
    task = held(0.02, ON_ITS_HEAD)
    states = run(task, 1.0, lambda time, now: upright(now, UP, 0.9 * weight if time < 0.2 else FIRM))
    slipped, end = grasp_point(states[60])[0], grasp_point(states[-1])[0]
    assert slipped < -0.025
    assert end == pytest.approx(slipped, abs=5e-3)


@pytest.mark.parametrize("grasp", [0.05, 0.1, 0.15])
def test_pushing_takes_the_friction_times_the_lever(grasp: float) -> None:
    place = np.array([0.0, 0.0, 0.045 + grasp])
    torques: list[float] = []

    def policy(time: float, now: State) -> Commands:
        commands = upright(now, place + max(time - 0.1, 0.0) * 0.1 * FORWARD, FIRM, 0.1 * FORWARD, 100.0)
        torques.append(-commands["hand", "torque"][1])
        return commands

    run(held(grasp, ON_ITS_HEAD, place, block=block()), 2.0, policy)
    assert np.mean(torques[-120:]) == pytest.approx(0.5 * 2.0 * GRAVITY * (grasp + 0.025), rel=0.05)


def test_fingers_close_on_the_handle_and_open_again() -> None:
    place = np.array([0.0, 0.0, 0.14])
    task = held(0.1, ON_ITS_HEAD, place, aperture=OPENED)
    states = run(task, 1.0, lambda time, now: upright(now, place, FIRM if time < 0.5 else -1.0))
    assert states[24]["hand", "aperture"][0] == pytest.approx(OPENED - 0.1 * FINGER_SPEED)
    assert states[100]["hand", "aperture"][0] == WIDTH
    assert states[-1]["hand", "aperture"][0] == OPENED
    aside = task.state.replace({("hand", "position"): place + 0.011 * LEFT})
    beside = run(task.replaced(state=aside), 0.5, lambda *_: {("hand", "grip"): np.array([FIRM])})
    assert beside[-1]["hand", "aperture"][0] == 0.0


def test_an_open_hand_passes_round_a_tool_and_not_through_a_thing() -> None:
    for things, stopped in (({}, False), ({"block": block()}, True)):
        task = held(0.0, ON_ITS_HEAD, np.array([0.0, 0.0, 0.04]), aperture=OPENED, **things)
        start = {("hand", "position"): (-0.1, 0.0, 0.05), ("hand", "velocity"): (0.5, 0.0, 0.0)}
        end = run(task.replaced(state=task.state.replace(start)), 0.5, lambda *_: {})[-1]
        assert np.linalg.norm(end["hammer", "velocity"]) < 1e-3
        assert (end["hand", "velocity"][0] < 0.4) == stopped


def test_the_same_commands_give_the_same_bits_whatever_was_before() -> None:
    task = held(0.1, ON_ITS_HEAD, np.array([0.0, 0.0, 0.145]), block=block())
    other = scene({("a", "position"): UP}, a=ball("a", Thing, mass=1.0), b=ball("b", Thing, mass=1.0))
    wiggle = np.array([3.0, 1.0, 8.0])

    def trajectory(backend: BulletBackend) -> bytes:
        rows = [backend.reset(task, task.state)]
        for step in range(240):
            grip = np.array([0.0 if 100 < step < 110 else 8.0])
            commands = {("hand", "force"): wiggle, ("hand", "torque"): 0.01 * wiggle, ("hand", "grip"): grip}
            rows.append(backend.step(commands))
        return b"".join(row.values.tobytes() for row in rows)

    with BulletBackend() as one, BulletBackend() as another:
        first = trajectory(one)
        another.reset(other, other.state)
        assert trajectory(another) == first
        assert trajectory(one) == first
        # All pairs of the hand and the tool collide again.
        fall = other.state.replace({("a", "position"): (0, 0, 0.2), ("b", "position"): (0, 0, 0.03)})
        one.reset(other, fall)
        assert any(one.step({})["b", "impulse"][0] > 0.5 for _ in range(120))


def test_what_an_action_needs_is_asked_for() -> None:
    task = scene({}, clumsy=ball("clumsy", Clumsy))
    with BulletBackend() as backend, pytest.raises(InputError) as refused:
        backend.reset(task, task.state)
    said = str(refused.value)
    for words in ("wrist_inertia", "maximal_aperture", "varying property aperture", "basic action force of size 3"):
        assert words in said
    for action in ("torque", "grip"):
        assert f"the basic action {action} of a hand that grips must have a limit" in said


def test_a_hand_that_grips_must_have_a_wrist_with_a_bounded_torque() -> None:
    """A hand without the basic action `torque` keeps its orientation, whatever the torque of its load."""
    task = scene({}, stiff=ball("stiff", Stiff, mass=1.0))
    wanted = "a token with the basic action grip must have the basic action torque of size 3"
    with BulletBackend() as backend, pytest.raises(InputError, match=wanted):
        backend.reset(task, task.state)


def test_torque_and_grip_have_limits() -> None:
    task = held(0.1, ON_ITS_HEAD)
    with BulletBackend() as backend:
        backend.reset(task, task.state)
        for action, command in (("torque", np.array([0.0, 21.0, 0.0])), ("grip", np.array([201.0]))):
            with pytest.raises(CommandError, match=f"{action} on hand must not exceed its limit"):
                backend.step({("hand", action): command})
