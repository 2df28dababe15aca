"""Tests of tumbling: the symbols agree with each other and with the margins, and the blocks do what they declare."""

import numpy as np
import pytest
from hybrid_tamp_domains.rolling_tumbling import DOMAIN
from hybrid_tamp_domains.rolling_tumbling.classes import Tumblable
from hybrid_tamp_domains.rolling_tumbling.faces import (
    EDGES,
    EXPOSED_HOLD,
    FACE,
    HOLDS_HOLD,
    LEANS_HOLD,
    LOWERS_HOLD,
    POSTURES,
    TIPS_HOLD,
    flat,
    over,
)
from hybrid_tamp_domains.rolling_tumbling.metrics import CONTROLLED
from hybrid_tamp_domains.rolling_tumbling.tumbling_geometry import edge_axis, lowest_point, nominal_tilt
from hybrid_tamp_domains.rolling_tumbling.tumbling_predicates import POSTURE
from pydantic import ValidationError
from random_tasks.tumbling import forced_push, random_tumbling

from hybrid_tamp.geometry.shapes import Cylinder
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.control import Parameters
from hybrid_tamp.model.expectation import expect
from hybrid_tamp.model.facts import facts
from hybrid_tamp.model.predicate import Value
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_axis_angle, quaternion_multiply
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.skills import NORMALS

DT = 1 / 240
TASK = random_tumbling(3)
BOX = TASK.token_by_name["box 1"]


def turned(state: State, down: str, forward: str, angle: float) -> State:
    """Return the state with the box turned about the edge between two faces and set down on the floor."""
    turn = quaternion_from_axis_angle(edge_axis(state, BOX, down, forward), np.asarray(angle))
    placed = state.replace({(BOX.name, "orientation"): quaternion_multiply(turn, state[BOX, "orientation"])})
    lower = np.array([0.0, 0.0, float(lowest_point(placed, BOX))])
    return placed.replace({(BOX.name, "position"): placed[BOX, "position"] - lower})


def holding(state: State) -> set[str]:
    return {posture for posture in POSTURES.symbols if POSTURE.evaluate(state, BOX, posture) >= 0}


def test_there_are_six_flat_postures_and_one_for_each_ordered_pair_of_adjacent_faces() -> None:
    assert len(FACE.symbols) == 6
    assert len(POSTURES.symbols) == 6 + 24 == len(set(POSTURES.symbols))
    assert (len(TIPS_HOLD), len(LEANS_HOLD), len(LOWERS_HOLD), len(HOLDS_HOLD)) == (24, 24, 48, 24)


@pytest.mark.parametrize("forward", ["left", "right", "front", "back"])
def test_one_posture_holds_at_each_stage_of_a_tumble_and_between_them_none(forward: str) -> None:
    stages = [flat("bottom"), over(forward, "bottom"), over("bottom", forward), flat(forward)]
    angles = [nominal_tilt(BOX, stage, "bottom", forward) for stage in stages]
    assert angles == sorted(angles)
    for stage, angle in zip(stages, angles, strict=True):
        assert holding(turned(TASK.state, "bottom", forward, angle)) == {stage}
    assert not holding(turned(TASK.state, "bottom", forward, (angles[0] + angles[1]) / 2))


def test_no_two_postures_ever_hold_together() -> None:
    for angle in np.linspace(0.0, np.pi / 2, 60):
        assert len(holding(turned(TASK.state, "bottom", "right", float(angle)))) <= 1


def test_a_box_in_the_air_stands_in_no_posture() -> None:
    lifted = TASK.state.replace({(BOX.name, "position"): TASK.state[BOX, "position"] + np.array([0.0, 0.0, 0.03])})
    assert not holding(lifted)


def test_every_face_that_a_tumble_needs_is_exposed() -> None:
    for near, far, before, _ in TIPS_HOLD | LOWERS_HOLD | LEANS_HOLD:
        assert {(near, before), (far, before)} <= EXPOSED_HOLD
    assert HOLDS_HOLD <= EXPOSED_HOLD


def test_the_initial_posture_is_read_off_the_state() -> None:
    postures = {atom.arguments for atom in facts(TASK) if atom.predicate == "posture"}
    assert postures == {("box 1", "flat bottom")}


@pytest.mark.parametrize("halves", [(0.1, 0.0, 0.1), (0.1, -0.1, 0.1)])
def test_half_extents_must_be_positive(halves: tuple[float, float, float]) -> None:
    with pytest.raises(ValidationError, match="greater than 0"):
        Token.make("box", [Tumblable], {"half_extents": halves, "mass": 1.0, "friction": 0.5})


def test_a_shape_that_is_not_the_box_is_refused() -> None:
    properties = {"half_extents": (0.1, 0.1, 0.1), "mass": 1.0, "friction": 0.5}
    drum = Token.make("box", [Tumblable], properties, Cylinder(kind="cylinder", radius=0.1, length=0.2))
    assert "box" in (Tumblable.consistent(drum) or "")
    assert Tumblable.consistent(Token.make("box", [Tumblable], properties)) is None


def run(block: Block, task: Task, state: State, roles: dict[str, str]) -> State:
    """Roll out the forward model of a block to its exit, and check that the entry conditions held."""
    binding: dict[str, Value] = task.bind(roles)
    for literal in block.entry:
        then = task.state if literal.predicate.static else state
        assert float(literal.margin(then, binding)) >= 0, f"{block.name}: {literal}"
    initial = block.initial_values(binding, state)
    policy = block.policy(binding, state, Parameters(initial)) if block.policy else None
    longest = round(expect(block, binding, state, initial).seconds / DT) + 240
    system = block.system_maker(binding, state)
    for step in range(longest):
        commands = policy(np.asarray(step * DT), state) if policy else {}
        state = system(state, commands, DT)
    for literal in block.exit:
        assert float(literal.margin(state, binding)) >= 0, f"{block.name}: {literal}"
    return state


def test_the_forward_models_bring_about_what_the_blocks_declare_all_through_a_tumble() -> None:
    tipped, back = over("bottom", "right"), over("right", "bottom")
    blocks = DOMAIN.block_by_name
    state = TASK.state

    def reach(state: State, hand: str, face: str, posture: str) -> State:
        roles = {"hand": hand, "object": "box 1", "face": face, "posture": posture}
        return run(blocks["REACHING:beside"], TASK, state, roles)

    def turn(state: State, mode: str, near: str, far: str, before: str, after: str) -> State:
        hands = {"first": "hand 1", "second": "hand 2", "object": "box 1"}
        return run(
            blocks[f"TIPPING:{mode}"],
            TASK,
            state,
            hands | {"near": near, "far": far, "before": before, "outcome": after},
        )

    state = reach(reach(state, "hand 1", "left", flat("bottom")), "hand 2", "right", flat("bottom"))
    state = turn(state, "opposite", "left", "right", flat("bottom"), tipped)
    roles = {"hand": "hand 2", "object": "box 1", "face": "right", "posture": tipped}
    state = run(blocks["TILTING"], TASK, state, roles)
    state = reach(state, "hand 1", "bottom", tipped)
    state = turn(state, "adjacent", "bottom", "right", tipped, back)
    state = reach(state, "hand 2", "top", back)
    state = turn(state, "lower", "bottom", "top", back, flat("right"))
    assert holding(state) == {flat("right")}


def test_each_hand_prefers_the_side_where_it_starts() -> None:
    on_side, can_work_at = (DOMAIN.predicate_by_name[name] for name in ("on_side", "can_work_at"))
    left, right = TASK.tokens[0], TASK.tokens[1]
    tipped, back = over("bottom", "right"), over("right", "bottom")
    for face, posture in (("left", flat("bottom")), ("bottom", tipped), ("bottom", back), ("left", tipped)):
        assert on_side.evaluate(TASK.state, left, BOX, face, posture) >= 0
        assert on_side.evaluate(TASK.state, right, BOX, face, posture) < 0
    for face, posture in (("right", flat("bottom")), ("right", tipped), ("top", back), ("top", tipped)):
        assert on_side.evaluate(TASK.state, right, BOX, face, posture) >= 0
        assert on_side.evaluate(TASK.state, left, BOX, face, posture) < 0
        assert can_work_at.evaluate(TASK.state, left, BOX, face, posture) >= 0
    assert can_work_at.evaluate(TASK.state, left, BOX, "front", flat("bottom")) < 0


def test_a_hand_that_is_not_parallel_to_an_edge_is_not_aligned() -> None:
    aligned, hand = DOMAIN.predicate_by_name["aligned"], TASK.tokens[0]
    upright = TASK.state.replace({(hand.name, "orientation"): np.array([0.0, 0.0, 0.0, 1.0])})
    for face in NORMALS:
        assert (aligned.evaluate(TASK.state, hand, BOX, face) >= 0) == (face not in ("front", "back"))
        assert aligned.evaluate(upright, hand, BOX, face) < 0


def test_margins_take_a_whole_population_at_once() -> None:
    many = TASK.state.repeated(3)
    predicates = [each for each in DOMAIN.predicates if all(TASK.values_of(p.sort) for p in each.parameters)]
    assert {"posture", "at_face", "strong_enough", "tips", "rough_enough"} <= {each.name for each in predicates}
    for predicate in predicates:
        values = [TASK.values_of(parameter.sort)[0] for parameter in predicate.parameters]
        margins = predicate.evaluate(many, *values)
        assert margins.shape == (3,), predicate
        assert np.allclose(margins, predicate.evaluate(TASK.state, *values)), predicate


def test_a_box_pushed_over_by_one_hand_is_not_controlled() -> None:
    with open_backend("pybullet") as physics:
        measures = forced_push(random_tumbling(2, hands=1), physics)
    assert measures["tilt [deg]"] == pytest.approx(90.0, abs=5.0)
    assert measures["touchdown [rad/s]"] > CONTROLLED["touchdown [rad/s]"][1]


def test_edges_are_ordered_pairs_of_adjacent_faces() -> None:
    assert len(set(EDGES)) == 24
    assert all({(down, forward), (forward, down)} <= set(EDGES) for down, forward in EDGES)
