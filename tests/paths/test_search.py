"""Paths through free space: clear of all bodies, equal for equal seeds, and none where there is no way."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hybrid_tamp.collision.bodies import Body, Pose, find_nearest
from hybrid_tamp.geometry.shapes import Box, Cylinder
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.paths.free_space import Carried, FreeSpace, Obstacle, OutOfChecks
from hybrid_tamp.paths.search import find_path

UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])
HAND = Carried(Body("hand", Cylinder(kind="cylinder", radius=0.035, length=0.16)), np.zeros(3), UPRIGHT)
LOWER, UPPER = np.array([-1.0, -1.0, 0.0]), np.array([1.0, 1.0, 1.5])
START, GOAL = np.array([-0.4, 0.0, 0.3]), np.array([0.4, 0.1, 0.3])
MARGIN = 0.01


def wall(x: float, y: float, halves: tuple[float, float, float], yaw: float = 0.0) -> Obstacle:
    """Return a wall on the floor, turned about the vertical by a yaw [rad]."""
    orientation = np.array([0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2)])
    body = Body("wall", Box(kind="box", half_extents=halves))
    return Obstacle(body, Pose(np.array([x, y, halves[2]]), orientation), MARGIN)


def space_with(*obstacles: Obstacle, ceiling: float = 10.0, most: int = 20_000) -> FreeSpace:
    """Return the free space of a hand between a floor and a ceiling [m]."""
    return FreeSpace([HAND], obstacles, lambda p: np.minimum(p[..., 2] - 0.1, ceiling - p[..., 2]), most)


def gap_along(path: FloatArray, obstacle: Obstacle) -> float:
    """Return the least distance from a body at samples every 2 mm of a path [m]."""
    found = []
    for one, other in pairwise(path):
        for share in np.linspace(0.0, 1.0, int(np.linalg.norm(other - one) / 2e-3) + 2):
            pose = HAND.at(one + share * (other - one))
            found.append(find_nearest(HAND.body, pose, obstacle.body, obstacle.pose).distance)
    return min(found)


@settings(max_examples=15, deadline=None)
@given(st.floats(-0.25, 0.25), st.floats(-0.3, 0.3), st.floats(0.1, 0.7), st.floats(0.0, 3.1), st.integers(0, 99))
def test_every_path_keeps_its_distance(x: float, y: float, width: float, yaw: float, seed: int) -> None:
    obstacle = wall(x, y, (0.03, width, 0.5), yaw)
    path = find_path(space_with(obstacle), START, GOAL, LOWER, UPPER, seed)
    if path is None:
        ends = [find_nearest(HAND.body, HAND.at(p), obstacle.body, obstacle.pose).distance for p in (START, GOAL)]
        assert min(ends) < MARGIN
        return
    assert np.array_equal(path[[0, -1]], [START, GOAL])
    assert gap_along(path, obstacle) > MARGIN - 2e-3


@pytest.mark.parametrize("seed", range(6))
def test_a_hand_in_contact_steps_away_from_the_body_first(seed: int) -> None:
    """Only segments near the normal of the contact are proven free, and samples hardly ever lie there."""
    start = np.array([-0.035 - 0.03 - 2e-5, 0.0, 0.3])
    touched = replace(wall(0.0, 0.0, (0.03, 0.3, 0.4)), margin=1e-5)
    space = space_with(touched, most=2_000)
    path = find_path(space, start, GOAL, LOWER, UPPER, seed)
    assert path is not None
    assert np.array_equal(path[[0, -1]], [start, GOAL])
    step = path[1] - start
    assert step[0] == pytest.approx(-np.linalg.norm(step), rel=1e-3)


def test_a_straight_way_needs_no_search() -> None:
    space = space_with(wall(0.0, 0.9, (0.03, 0.2, 0.5)))
    assert find_path(space, START, GOAL, LOWER, UPPER, 0) is not None
    assert space.checks < 20


def test_equal_seeds_give_equal_bits_and_other_seeds_give_other_paths() -> None:
    obstacle = wall(0.0, 0.0, (0.05, 0.6, 0.5))
    one, again, other = (find_path(space_with(obstacle), START, GOAL, LOWER, UPPER, seed) for seed in (7, 7, 8))
    assert one is not None
    assert again is not None
    assert other is not None
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


def test_the_number_of_checks_ends_a_search_without_a_path() -> None:
    closed = space_with(wall(0.0, 0.0, (0.05, 3.0, 0.5)), ceiling=0.8, most=3000)
    assert find_path(closed, START, GOAL, LOWER, UPPER, 0) is None
    assert closed.checks == 3000
    with pytest.raises(OutOfChecks):
        closed.slack(START)


def test_a_start_inside_a_body_has_no_path() -> None:
    space = space_with(wall(-0.4, 0.0, (0.05, 0.3, 0.5)))
    assert find_path(space, START, GOAL, LOWER, UPPER, 0) is None
    assert space.checks < 10
