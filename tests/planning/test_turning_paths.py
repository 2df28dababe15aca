"""Paths of bodies that have no room for their turn at the start or at the goal."""

from itertools import pairwise

import numpy as np
import pytest

from hybrid_tamp.collision.bodies import Body, Pose
from hybrid_tamp.geometry.shapes import Box, Cylinder
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rpy
from hybrid_tamp.paths.free_space import Carried, FreeSpace, Obstacle
from hybrid_tamp.paths.search import find_path
from hybrid_tamp.planning.turning_paths import find_turning_path

HAND = Body("hand", Cylinder(kind="cylinder", radius=0.035, length=0.16))
LYING, LEANING, UPRIGHT = (quaternion_from_rpy(np.array([angle, 0.0, 0.0])) for angle in (np.pi / 2, np.pi / 4, 0.0))
BOX = Body("box", Box(kind="box", half_extents=(0.15, 0.15, 0.2)))
LIMITS = np.array([-1.0, -1.0, 0.0]), np.array([1.0, 1.0, 1.2])
BESIDE, BEHIND = np.array([0.2, 0.0, 0.1]), np.array([0.0, 0.2, 0.3])


def space(*orientations: FloatArray, wall: float = 1.0) -> FreeSpace:
    """Return the free space of a hand in all given orientations, beside a box and a wall at an x [m]."""
    boxes = (BOX, np.array([0.0, 0.0, 0.2])), (BOX, np.array([wall + 0.15, 0.0, 0.2]))
    obstacles = [Obstacle(body, Pose(place, UPRIGHT), 0.01) for body, place in boxes]
    carried = [Carried(HAND, np.zeros(3), each) for each in orientations]
    return FreeSpace(carried, obstacles, lambda p: np.minimum(p[..., 2] - 0.05, 1.2 - p[..., 2]), 20_000)


def test_a_hand_leaves_the_box_turns_and_approaches_its_place() -> None:
    """The lying hand starts beside the box. It points to the box at its place, unless it has turned."""
    turning, ends = space(LYING, LEANING, UPRIGHT), (space(LYING), space(UPRIGHT))
    assert find_path(turning, BESIDE, BEHIND, *LIMITS, 0) is None
    assert find_path(space(LYING), BESIDE, BEHIND, *LIMITS, 0) is None
    path = find_turning_path(turning, ends, BESIDE, BEHIND, LIMITS, 0)
    assert path is not None
    assert np.array_equal(path[[0, -1]], [BESIDE, BEHIND])
    assert len(path) >= 4
    assert ends[0].is_free(*path[:2])
    assert ends[1].is_free(*path[-2:])
    assert all(turning.is_free(*leg) for leg in pairwise(path[1:-1]))
    again = find_turning_path(space(LYING, LEANING, UPRIGHT), ends, BESIDE, BEHIND, LIMITS, 0)
    assert np.array_equal(path, again)


@pytest.mark.parametrize("orientation", [LYING, UPRIGHT])
def test_a_hand_with_room_at_both_ends_turns_anywhere_between_them(orientation: FloatArray) -> None:
    start, goal = np.array([-0.6, 0.0, 0.3]), np.array([0.0, 0.6, 0.3])
    turning = space(LYING, LEANING, UPRIGHT)
    path = find_turning_path(turning, (space(orientation), space(UPRIGHT)), start, goal, LIMITS, 0)
    assert path is not None
    assert np.array_equal(path[0], path[1])
    assert all(turning.is_free(*leg) for leg in pairwise(path))


def test_without_room_for_the_turn_there_is_no_path() -> None:
    start = np.array([0.21, 0.0, 0.1])
    narrow = [space(*orientations, wall=0.27) for orientations in ((LYING, UPRIGHT), (LYING,), (UPRIGHT,))]
    turning, first, last = narrow
    turning.admits = lambda p: np.minimum(p[..., 2] - 0.05, 0.2 - p[..., 2])
    first.admits = last.admits = turning.admits
    assert find_turning_path(turning, (first, last), start, BEHIND, LIMITS, 0) is None
