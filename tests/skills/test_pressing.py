"""Hands that press on the faces of a box: the policy agrees with closed forms, and hands stop at faces."""

from pathlib import Path

import numpy as np
import pytest

import hybrid_tamp
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_axis_angle
from hybrid_tamp.skills import (
    STIFFNESS,
    TOUCHING_FORCE,
    UP,
    Pressure,
    contact_distance,
    gap_to_face,
    gaps_to_faces,
    half_extent,
    meet_face,
    normals,
    press,
)

TASK = hybrid_tamp.load_task(Path(__file__).resolve().parents[2] / "problems" / "lift_two_hands.yaml")
BOX = TASK.token_by_name["box"]
LEFT, RIGHT = (token for token in TASK.tokens if token.basic_actions)
CONTACTS = ((LEFT, "left"), (RIGHT, "right"))
ZERO, ONE = np.asarray(0.0), np.asarray(1.0)
SQUEEZE, GAP = 20.0, 0.012


def beside() -> State:
    """Return the state with resting hands at the middles of the left and right faces, with a gap of 1.2 cm."""
    centre, away = TASK.state[BOX, "position"], half_extent(BOX, "right") + LEFT["radius"] + GAP
    left, right = normals(TASK.state, BOX, "left", "right")
    return TASK.state.replace(
        {(LEFT.name, "position"): centre + away * left, (RIGHT.name, "position"): centre + away * right}
    )


def forces(planned: Pressure, state: State, softness: float = 1.0, pivot: FloatArray | float = 0.0) -> list[FloatArray]:
    start = beside()
    gaps = gaps_to_faces(CONTACTS, BOX, start)
    policy = press(CONTACTS, BOX, start, gaps, np.asarray(SQUEEZE), lambda elapsed, state: planned, pivot, softness)
    commands = policy(np.float64(0.0), state)
    return [commands[hand.name, "force"] for hand in (LEFT, RIGHT)]


def touching() -> State:
    """Return the state in which both hands touch their faces."""
    start = beside()
    left, right = normals(start, BOX, "left", "right")
    return start.replace(
        {
            (LEFT.name, "position"): start[LEFT, "position"] - GAP * left,
            (RIGHT.name, "position"): start[RIGHT, "position"] - GAP * right,
        }
    )


def test_hands_that_touch_their_faces_press_with_the_squeeze_and_bear_their_share_of_the_weight() -> None:
    assert [float(gap) for gap in gaps_to_faces(CONTACTS, BOX, beside())] == pytest.approx([GAP, GAP])
    found = forces(Pressure(ONE, ZERO, ONE, np.zeros(3), bearing=5.0 * UP), touching())
    for force, outward in zip(found, normals(TASK.state, BOX, "left", "right"), strict=True):
        assert force == pytest.approx(-SQUEEZE * outward + 5.0 * UP, abs=1e-9)


@pytest.mark.parametrize("softness", [1.0, 0.1])
def test_a_soft_hand_gives_way_along_the_normal_of_its_face_only(softness: float) -> None:
    outward = normals(TASK.state, BOX, "left")[0]
    moved = touching()
    moved = moved.replace({(LEFT.name, "position"): moved[LEFT, "position"] - 0.001 * outward + 0.002 * UP})
    force = forces(Pressure(ONE, ZERO, ONE, np.zeros(3)), moved, softness)[0]
    assert force == pytest.approx((softness * STIFFNESS * 0.001 - SQUEEZE) * outward - STIFFNESS * 0.002 * UP)


def test_hands_move_and_turn_with_the_object_as_one_rigid_body() -> None:
    """The reference of a hand turns about the pivot, and has the velocity of this rotation."""
    pivot = TASK.state[BOX, "position"]
    turn, spin = quaternion_from_axis_angle(UP, np.asarray(np.pi / 2)), 0.3 * UP
    start = beside()
    arms = [start[hand, "position"] - pivot for hand in (LEFT, RIGHT)]
    turned = {
        (hand.name, "position"): pivot + np.array([-arm[1], arm[0], arm[2]])
        for hand, arm in zip((LEFT, RIGHT), arms, strict=True)
    }
    velocities = {
        (hand.name, "velocity"): np.cross(spin, turned[hand.name, "position"] - pivot) for hand in (LEFT, RIGHT)
    }
    planned = Pressure(ZERO, ZERO, ZERO, pivot, turned=turn, spin=spin)
    for force in forces(planned, start.replace(turned | velocities), pivot=pivot):
        assert force == pytest.approx(np.zeros(3), abs=1e-6)


def test_a_hand_with_a_loosened_grip_hardly_presses() -> None:
    outward = normals(TASK.state, BOX, "left")[0]
    away = touching()
    away = away.replace({(LEFT.name, "position"): away[LEFT, "position"] + 0.01 * outward})
    pressing = forces(Pressure(ONE, ZERO, ZERO, np.zeros(3), loose=ZERO), away)[0]
    assert -float(pressing @ outward) == pytest.approx(0.01 * STIFFNESS)
    loosened = forces(Pressure(ONE, ZERO, ZERO, np.zeros(3), loose=ONE), away)[0]
    assert -float(loosened @ outward) == pytest.approx(TOUCHING_FORCE)


def test_a_hand_stops_at_its_face_and_then_touches_it() -> None:
    outward, dt = normals(TASK.state, BOX, "left")[0], 0.01
    state = beside().replace({(LEFT.name, "velocity"): -2.0 * outward})
    velocity, touches = meet_face(state, LEFT, outward, gap_to_face(state, LEFT, BOX, "left"), {}, dt)
    assert not touches
    after = state.replace({(LEFT.name, "position"): state[LEFT, "position"] + velocity * dt})
    assert float(gap_to_face(after, LEFT, BOX, "left")) == pytest.approx(0.0, abs=1e-12)
    assert meet_face(after, LEFT, outward, gap_to_face(after, LEFT, BOX, "left"), {}, dt)[1]


def test_hands_touch_the_bottom_of_a_hollow() -> None:
    task = hybrid_tamp.load_task(Path(__file__).resolve().parents[2] / "problems" / "tumble_left.yaml")
    box = next(token for token in task.tokens if "half_extents" in token.properties)
    hollow = type(box).make("hollow box", box.classes, {**box.properties, "hollow": (0.01, 0.0, 0.0)}, shape=box.shape)
    assert contact_distance(hollow, "left") == pytest.approx(half_extent(hollow, "left") - 0.01)
    assert contact_distance(hollow, "top") == half_extent(hollow, "top") == half_extent(hollow, "bottom")


@pytest.mark.parametrize("spin", [None, np.zeros(3)])
@pytest.mark.parametrize("rise", [None, 0.1 * UP])
def test_a_closing_hand_approaches_its_face_while_the_object_moves(
    spin: FloatArray | None, rise: FloatArray | None
) -> None:
    """A hand that has closed half of the gap, and moves with the reference, needs no force."""
    outward = normals(TASK.state, BOX, "left")[0]
    planned = Pressure(np.asarray(0.5), np.asarray(2.0), ZERO, np.zeros(3), velocity=rise, spin=spin)
    velocity = -2.0 * GAP * outward + (rise if rise is not None and spin is None else 0.0)
    state = beside()
    state = state.replace(
        {(LEFT.name, "position"): state[LEFT, "position"] - 0.5 * GAP * outward, (LEFT.name, "velocity"): velocity}
    )
    assert forces(planned, state)[0] == pytest.approx(np.zeros(3), abs=1e-6)
