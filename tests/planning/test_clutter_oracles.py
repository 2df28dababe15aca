"""The oracles name what is in the way, and their distances agree with an independent computation."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_tasks.arranging import Arrangement
from random_tasks.clutter_families import FAMILIES
from random_tasks.flood import flood
from random_tasks.oracle import Opinion
from random_tasks.oracles import confirm, consult
from random_tasks.upright import UP, Floats, Part, Room, gap

from hybrid_tamp.geometry.convex import placed
from hybrid_tamp.geometry.gaps import distance_between
from hybrid_tamp.geometry.shapes import Box, Sphere
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.skills import HORIZONTAL

SEED = 1
FAR = np.array([-5.0] * 3), np.array([5.0] * 3)
HALVES = st.tuples(*[st.floats(0.02, 0.3)] * 3)
PLACES = st.tuples(*[st.floats(-0.6, 0.6)] * 3)
YAWS = st.floats(-3.1, 3.1)


def with_walls(family: str, *walls: tuple[Floats, tuple[float, float, float]]) -> Task:
    """Return a task of a family on an empty floor with walls, given as pairs of (position, half extents) [m]."""
    task = FAMILIES[family](SEED)
    scene = Arrangement.of(task)
    for number, (place, halves) in enumerate(walls):
        wall = Token.make(f"wall-{number}", [], {}, Box(kind="box", half_extents=halves), immovable=True)
        scene.add(wall, np.asarray(place))
    return scene.task(task, "walled")


def caged(place: Floats) -> list[tuple[Floats, tuple[float, float, float]]]:
    """Return five walls around a place, whose free room is 0.2 m wide and 0.4 m high."""
    sides = [(x, y) for x in (-0.11, 0.0, 0.11) for y in (-0.11, 0.0, 0.11) if (x == 0.0) != (y == 0.0)]
    cage = [(place + np.array([x, y, 0.0]), (0.01 + abs(y), 0.01 + abs(x), 0.21)) for x, y in sides]
    return [*cage, (place + 0.22 * UP, (0.12, 0.12, 0.01)), (place - 0.22 * UP, (0.12, 0.12, 0.01))]


@given(halves=HALVES, place=PLACES, yaw=YAWS, radius=st.floats(0.01, 0.2))
def test_the_gap_of_a_ball_is_exact(
    halves: tuple[float, float, float], place: tuple[float, float, float], yaw: float, radius: float
) -> None:
    (box,) = placed(Box(kind="box", half_extents=halves), np.zeros(3), quaternion_from_rpy(np.array([0.0, 0.0, yaw])))
    (ball,) = placed(Sphere(kind="sphere", radius=radius), np.array(place), np.array([0.0, 0.0, 0.0, 1.0]))
    x, y, z = np.array(place)[:, None]
    found = gap(Part(np.zeros(3), halves, yaw), Part(np.zeros(3), radius=radius, ball=True), x, y, z)
    assert max(float(found[0]), 0.0) == pytest.approx(distance_between(box, ball), abs=1e-4)


@given(halves=st.tuples(HALVES, HALVES), place=PLACES, yaws=st.tuples(YAWS, YAWS))
def test_the_gap_of_a_box_has_the_sign_of_its_distance(
    halves: tuple[tuple[float, float, float], ...], place: tuple[float, float, float], yaws: tuple[float, float]
) -> None:
    turns = [quaternion_from_rpy(np.array([0.0, 0.0, yaw])) for yaw in yaws]
    shapes = [Box(kind="box", half_extents=each) for each in halves]
    (one,), (other,) = placed(shapes[0], np.zeros(3), turns[0]), placed(shapes[1], np.array(place), turns[1])
    x, y, z = np.array(place)[:, None]
    found = float(gap(Part(np.zeros(3), halves[0], yaws[0]), Part(np.zeros(3), halves[1], yaws[1]), x, y, z)[0])
    distance = distance_between(one, other)
    assert found <= distance + 1e-6
    assert distance < 1e-4 or found > 0.0


@pytest.mark.parametrize(
    ("width", "strict", "generous"), [(0.1, False, True), (0.16, True, True), (0.04, False, False)]
)
def test_a_flood_passes_a_gap_that_is_wide_enough(width: float, strict: bool, generous: bool) -> None:
    halves = (0.05, 1.0, 5.0)
    walls = tuple(Part(np.array([0.0, sign * (1.0 + width / 2), 0.0]), halves) for sign in (-1.0, 1.0))
    ball = (Part(np.zeros(3), radius=0.06, ball=True),)
    limits = np.array([-0.5, -0.9, 0.0]), np.array([0.5, 0.9, 0.5])
    ends = np.array([-0.4, 0.0, 0.2]), np.array([0.4, 0.0, 0.2])
    assert flood(Room(walls), ball, ends[0], [ends[1]], limits) == [strict]
    assert flood(Room(walls), ball, ends[0], [ends[1]], limits, generous=True) == [generous]


@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_an_empty_scene_is_solvable(family: str) -> None:
    assert consult(family, with_walls(family)) == Opinion("solvable")
    assert confirm(family, with_walls(family)) == ""


@pytest.mark.parametrize("family", ["roll", "tumble_two", "carry_two", "hammer"])
def test_a_caged_hand_is_proven_to_have_no_way(family: str) -> None:
    task = FAMILIES[family](SEED)
    cages = [caged(task.state[hand, "position"] * HORIZONTAL + 0.5 * UP) for hand in task.tokens if hand.basic_actions]
    scene = Arrangement.of(with_walls(family, *(wall for cage in cages for wall in cage)))
    for hand in task.tokens:
        if hand.basic_actions:
            scene.shift(hand.name, [0.0, 0.0, 0.5 - scene.poses[hand.name][0][2]])
    opinion = consult(family, scene.task(task, "caged"))
    assert opinion.verdict == "impossible"
    assert "no way" in opinion.proof


@pytest.mark.parametrize(
    ("family", "thing", "why"),
    [
        ("roll", "cylinder", "the drum hits something"),
        ("carry_two", "box", "the box hits something at the region"),
        ("hammer", "block", "the block hits something"),
    ],
)
def test_a_covered_region_is_impossible(family: str, thing: str, why: str) -> None:
    task = FAMILIES[family](SEED)
    where = task.state["goal", "position"] * HORIZONTAL + 0.5 * UP
    opinion = consult(family, with_walls(family, (where, (0.03, 0.03, 0.5))))
    assert (opinion.verdict, opinion.why) == ("impossible", why)


def test_a_box_that_cannot_be_tumbled_in_one_way_is_grey_and_in_no_way_impossible() -> None:
    task = FAMILIES["tumble_two"](SEED)
    box = task.state["box 1", "position"] * HORIZONTAL
    ahead, *others = [
        (box + 0.36 * np.array([*way, 0.0]) + 0.25 * UP, (0.02 + 0.2 * abs(way[1]), 0.02 + 0.2 * abs(way[0]), 0.25))
        for way in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
    ]
    one_way = consult("tumble_two", with_walls("tumble_two", ahead))
    assert (one_way.verdict, one_way.proof) == ("grey", "")
    assert consult("tumble_two", with_walls("tumble_two", ahead, *others)).verdict == "impossible"
