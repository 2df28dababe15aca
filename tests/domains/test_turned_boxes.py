"""Boxes with any yaw: hands that can turn tumble them from anywhere, and hands that cannot turn are refused."""

import numpy as np
import pytest
from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from hybrid_tamp_domains.rolling_tumbling.classes import Tumblable
from hybrid_tamp_domains.rolling_tumbling.detours import route_to_face
from hybrid_tamp_domains.rolling_tumbling.faces import EXPOSED_HOLD, FACE
from hybrid_tamp_domains.rolling_tumbling.metrics import CONTROLLED
from hybrid_tamp_domains.rolling_tumbling.tumbling_geometry import place_at
from hybrid_tamp_domains.rolling_tumbling.turning_hands import ALIGNMENT
from hypothesis import given, settings
from hypothesis import strategies as st
from random_tasks.turned import BOX, YAWS, random_turned, stiff_turned, yaw_of

import hybrid_tamp
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_axis_angle, quaternion_multiply, rotate, rotation_vector
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.questions.explain.no_plan import explain
from hybrid_tamp.report.measures import CONTACT, run_measures
from hybrid_tamp.skills import UP, normal, z_axis

TASK, STIFF = random_turned(0), stiff_turned(0)
SIDES = ("left", "right", "front", "back")
_COMPONENT = st.floats(-1.0, 1.0)
ORIENTATIONS = st.tuples(*[_COMPONENT] * 4).filter(lambda q: float(np.linalg.norm(q)) > 0.1)
PLACES = st.tuples(st.floats(-0.8, 0.8), st.floats(-0.8, 0.8), st.floats(0.1, 0.8))
ANGLES = st.floats(-np.pi, np.pi)


def moved(task: Task, place: tuple[float, ...], orientation: tuple[float, ...]) -> State:
    """Return the initial state with another pose of the first hand."""
    unit = np.asarray(orientation) / np.linalg.norm(orientation)
    return task.state.replace({("hand 1", "position"): np.asarray(place), ("hand 1", "orientation"): unit})


def turned(state: State, angle: float) -> State:
    """Return the whole scene, turned about the vertical through the origin."""
    turn = quaternion_from_axis_angle(UP, np.asarray(angle))
    changes = {}
    for name in ("hand 1", "hand 2", "box 1"):
        changes[name, "position"] = rotate(turn, state[name, "position"])
        changes[name, "orientation"] = quaternion_multiply(turn, state[name, "orientation"])
    return state.replace(changes)


@given(PLACES, ORIENTATIONS, st.sampled_from(SIDES))
def test_a_hand_turns_by_the_smallest_angle_until_it_is_level_and_parallel_to_its_face(
    place: tuple[float, ...], orientation: tuple[float, ...], face: str
) -> None:
    state, (hand, _, box) = moved(TASK, place, orientation), TASK.tokens
    wanted = ALIGNMENT.orientation(state, hand, box, face)
    axis = rotate(wanted, UP)
    assert abs(axis[2]) < 1e-9
    assert abs(axis @ normal(state, box, face)) < 1e-9
    turn = rotation_vector(quaternion_multiply(wanted, state[hand, "orientation"] * (-1.0, -1.0, -1.0, 1.0)))
    assert np.linalg.norm(turn) <= np.pi / 2 + 1e-9
    assert np.linalg.norm(turn) == pytest.approx(float(ALIGNMENT.angle(state, hand, box, face)), abs=1e-7)
    assert turn @ z_axis(state, hand) == pytest.approx(0.0, abs=1e-9)  # The hand does not turn about its own axis.


@given(PLACES, ORIENTATIONS, st.sampled_from(SIDES), ANGLES)
def test_what_a_hand_wants_turns_with_the_scene(
    place: tuple[float, ...], orientation: tuple[float, ...], face: str, angle: float
) -> None:
    before, (hand, _, box) = moved(TASK, place, orientation), TASK.tokens
    after, turn = turned(before, angle), quaternion_from_axis_angle(UP, np.asarray(angle))
    there = ALIGNMENT.direction(after, hand, box, face)
    assert abs(there @ rotate(turn, ALIGNMENT.direction(before, hand, box, face))) == pytest.approx(1.0)
    assert np.allclose(place_at(after, hand, box, face), rotate(turn, place_at(before, hand, box, face)))


@settings(deadline=None)
@given(PLACES, ORIENTATIONS, st.sampled_from([TASK, STIFF]), st.sampled_from(FACE.symbols))
def test_every_route_ends_at_the_face(
    place: tuple[float, ...], orientation: tuple[float, ...], task: Task, face: str
) -> None:
    """A route for a hand that was more than 45 degrees off its face once went around the box for ever."""
    state, (hand, _, box) = moved(task, place, orientation), task.tokens
    route = route_to_face(state, hand, box, face)
    assert len(route.corners) <= 7
    assert np.allclose(route.corners[0], state[hand, "position"])
    assert np.allclose(route.corners[-1], place_at(state, hand, box, face), atol=1e-9)


def test_a_hand_that_can_turn_works_on_both_sides_but_only_about_edges_that_it_can_turn() -> None:
    """The box is 1.8 times as high as it is wide from the front to the back, and hands turn at most 1.6 times."""
    can_work_at, low_enough = (DOMAIN.predicate_by_name[name] for name in ("can_work_at", "low_enough"))
    hand, box = TASK.tokens[0], Token.make("box 1", [Tumblable], BOX | {"half_extents": (0.15, 0.1, 0.18)})
    able = {face: float(can_work_at.evaluate(TASK.state, hand, box, face, "flat bottom")) >= 0 for face in SIDES}
    assert able == {"left": True, "right": True, "front": False, "back": False}
    assert float(low_enough.evaluate(TASK.state, hand, box)) >= 0
    assert float(can_work_at.evaluate(TASK.state, hand, box, "bottom", "over bottom right")) >= 0
    assert float(can_work_at.evaluate(TASK.state, hand, box, "bottom", "over bottom front")) < 0


def test_hands_that_cannot_turn_are_refused_beyond_six_degrees() -> None:
    aligned, exposed = DOMAIN.predicate_by_name["aligned"], {face for face, at in EXPOSED_HOLD if at == "flat bottom"}
    for seed in range(YAWS):
        task = stiff_turned(seed)
        hand, box = task.tokens[0], task.tokens[-1]
        off = abs((np.degrees(yaw_of(seed)) + 45.0) % 90.0 - 45.0)
        margins = [float(aligned.evaluate(task.state, hand, box, face)) for face in sorted(exposed)]
        assert max(margins) == pytest.approx(np.radians(6.0 - off)), seed
        able = random_turned(seed)
        margins = [float(aligned.evaluate(able.state, able.tokens[0], able.tokens[-1], face)) for face in exposed]
        assert min(margins) > 0.0, seed


@pytest.mark.parametrize(("seed", "angle"), [(2, 10), (9, 45), (31, 25)])
def test_the_refusal_says_that_the_hand_cannot_turn_and_states_the_angle(seed: int, angle: int) -> None:
    (reason,) = explain(stiff_turned(seed))
    assert reason.atom is not None
    assert reason.atom.predicate == "aligned"
    assert "hand 1 cannot turn, and its axis is not level or not parallel to the" in reason.message
    assert f"({angle} degrees, but at most 6 degrees are possible; a limit of the available actions" in reason.message


def test_hands_tumble_a_turned_box_from_the_same_side() -> None:
    task = hybrid_tamp.load_task("tumble_turned_box")
    plan = hybrid_tamp.plan(task).required()
    first = {each.targets["face"]: each.slots["hand"] for each in plan.instances[::-1] if "face" in each.targets}
    assert (first["left"], first["right"]) == ("hand-2", "hand-1")  # The ways of the other choice cross.
    with open_backend("pybullet") as physics:
        recording = execute(task, plan, physics)
    assert recording.success
    assert not check_law(task, recording.plan, recording.at)
    assert task.domain.metrics is not None
    for (_, name), value in task.domain.metrics(task, recording).items():
        low, high = CONTROLLED[name]
        assert low <= value <= high, name
    assert dict(run_measures(plan, recording))[CONTACT] < 5.0
