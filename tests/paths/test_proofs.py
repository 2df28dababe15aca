"""A ball is proven to be cut off only if no path exists, and closed rooms are recognised."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hybrid_tamp.collision.bodies import Body, Pose
from hybrid_tamp.geometry.convex import ConvexBody, placed
from hybrid_tamp.geometry.shapes import Box, Sphere
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.paths.free_space import Carried, FreeSpace, Obstacle
from hybrid_tamp.paths.proofs import Ball, Margins, is_barred, is_cut_off
from hybrid_tamp.paths.search import find_path

UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])
START, END = np.array([-0.4, 0.0, 0.3]), np.array([0.4, 0.0, 0.3])
LOWER, UPPER = np.array([-1.0, -1.0, 0.0]), np.array([1.0, 1.0, 1.0])
RADIUS = 0.08
ROOM = np.array([0.8, 0.8, 0.8])
"""Upper corner of the room in which the ball is allowed [m]. The lower corner is (-0.8, -0.8, 0)."""

Wall = tuple[tuple[float, float, float], tuple[float, float, float], float]
"""Position [m], half extents [m] and yaw [rad] of a wall."""


def body(wall: Wall) -> ConvexBody:
    place, halves, yaw = wall
    orientation = np.array([0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2)])
    (solid,) = placed(Box(kind="box", half_extents=halves), np.array(place), orientation)
    return solid


def in_room(positions: FloatArray) -> FloatArray:
    lower = positions - np.array([-0.8, -0.8, 0.0])
    return np.minimum(lower, ROOM - positions).min(axis=-1)


def near(place: FloatArray, tolerance: float = 0.02) -> Margins:
    return lambda positions: tolerance - np.linalg.norm(positions - place, axis=-1)


def cut_off(*walls: Wall, radius: float = RADIUS) -> bool:
    return is_cut_off(Ball(radius, START, END), [body(each) for each in walls], in_room, near(END))


def gap(width: float) -> tuple[Wall, Wall]:
    """Return two walls from the floor to the ceiling that leave a gap of a width [m] between them."""
    half = (1.0 - width / 2) / 2
    return tuple(((0.0, side * (width / 2 + half), 0.5), (0.05, half, 0.5), 0.0) for side in (-1, 1))  # type: ignore[return-value]


def test_a_wall_across_the_whole_room_cuts_off() -> None:
    assert cut_off(((0.0, 0.0, 0.5), (0.05, 1.0, 0.5), 0.0))


@pytest.mark.parametrize(
    "wall", [((0.0, 0.0, 0.25), (0.05, 1.0, 0.25), 0.0), ((0.0, -0.4, 0.5), (0.05, 0.6, 0.5), 0.0)]
)
def test_a_wall_that_ends_below_the_ceiling_or_beside_the_way_does_not(wall: Wall) -> None:
    assert not cut_off(wall)


@pytest.mark.parametrize("width", [0.01, 0.5 * 2 * RADIUS])
def test_a_gap_of_half_the_width_is_closed(width: float) -> None:
    assert cut_off(*gap(width))


@pytest.mark.parametrize("width", [1.001 * 2 * RADIUS, 1.2 * 2 * RADIUS])
def test_a_gap_that_lets_the_ball_through_is_never_closed(width: float) -> None:
    assert not cut_off(*gap(width))


def test_a_goal_inside_a_body_cannot_be_reached() -> None:
    assert cut_off(((0.4, 0.0, 0.3), (0.1, 0.1, 0.3), 0.0))


def test_a_start_that_is_closed_proves_nothing() -> None:
    assert not cut_off(((-0.4, 0.0, 0.5), (0.3, 1.0, 0.5), 0.0))


def test_a_goal_of_unknown_size_proves_nothing() -> None:
    wall = body(((0.0, 0.0, 0.5), (0.05, 1.0, 0.5), 0.0))
    assert not is_cut_off(Ball(RADIUS, START, END), [wall], in_room, lambda p: np.full(len(p), np.inf))


@st.composite
def walls(draw: st.DrawFn) -> Wall:
    halves = tuple(draw(st.floats(0.02, 0.8)) for _ in range(3))
    place = (draw(st.floats(-0.2, 0.2)), draw(st.floats(-0.6, 0.6)), halves[2])
    return place, halves, draw(st.sampled_from([0.0, 0.3, np.pi / 2, 2.0]))  # type: ignore[return-value]


@settings(max_examples=40, deadline=None)
@given(st.lists(walls(), min_size=1, max_size=3), st.integers(0, 99))
def test_whoever_is_cut_off_has_no_path(drawn: list[Wall], seed: int) -> None:
    ball = Carried(Body("ball", Sphere(kind="sphere", radius=RADIUS)), np.zeros(3), UPRIGHT)
    obstacles = []
    for place, halves, yaw in drawn:
        pose = Pose(np.array(place), np.array([0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2)]))
        obstacles.append(Obstacle(Body("wall", Box(kind="box", half_extents=halves)), pose, 0.0))
    space = FreeSpace([ball], obstacles, lambda p: np.minimum(in_room(p), p[..., 2] - RADIUS), 4000)
    found = find_path(space, START, END, LOWER, UPPER, seed)
    assert found is None or not cut_off(*drawn)


def barred(wall: Wall, goal: Margins, aside: float = 0.005) -> bool:
    return is_barred([Ball(RADIUS, START, END)], [body(wall)], np.array([1.0, 0.0, 0.0]), goal, aside)


def test_a_straight_way_is_barred_by_what_stands_before_its_goal() -> None:
    assert barred(((0.0, 0.0, 0.5), (0.05, 0.05, 0.5), 0.0), near(END))
    assert not barred(((0.0, 0.0, 0.5), (0.05, 0.05, 0.5), 0.0), near(END, 0.7))  # The goal begins before the post.
    assert not barred(((0.55, 0.0, 0.5), (0.05, 0.05, 0.5), 0.0), near(END))
    assert not barred(((0.0, 0.0, 0.5), (0.05, 0.05, 0.5), 0.0), near(END + 3.0))  # Nothing is known that far away.


@settings(max_examples=40, deadline=None)
@given(st.floats(-0.3, 0.3), st.floats(-0.5, 0.5), st.floats(0.02, 0.2), st.floats(0.0, 3.1))
def test_who_is_barred_has_no_free_way(x: float, y: float, half: float, yaw: float) -> None:
    if not barred(((x, y, 0.5), (half, 0.1, 0.5), yaw), near(END, 0.1)):
        return
    ball, box = Body("ball", Sphere(kind="sphere", radius=RADIUS)), Box(kind="box", half_extents=(half, 0.1, 0.5))
    pose = Pose(np.array([x, y, 0.5]), np.array([0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2)]))
    obstacle = Obstacle(Body("wall", box), pose, 0.0)
    for aside in (-0.005, 0.0, 0.005):
        space = FreeSpace(
            [Carried(ball, np.zeros(3), UPRIGHT)], [obstacle], lambda p: np.full(p.shape[:-1], np.inf), 10**6
        )
        across = np.array([0.0, aside, 0.0])
        assert not space.is_free(START + across, END + across - np.array([0.1, 0.0, 0.0]))
