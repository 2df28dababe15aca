"""Paths through narrow gaps: the narrowest place of a grid, the margins there, and corners that are rounded."""

from itertools import pairwise

import numpy as np
import pytest

from hybrid_tamp.collision.bodies import Body, Pose, find_nearest
from hybrid_tamp.geometry.shapes import Box, Cylinder
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.curves import round_corners
from hybrid_tamp.paths.free_space import Carried, FreeSpace, Obstacle
from hybrid_tamp.paths.grid import Grid
from hybrid_tamp.paths.narrow import SMALLEST_MARGIN, find_widest, refine_corners
from hybrid_tamp.paths.search import find_path

UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])
HALVES = (0.15, 0.14, 0.12)
BOX = Carried(Body("box", Box(kind="box", half_extents=HALVES)), np.zeros(3), UPRIGHT)
HAND = Body("hand", Cylinder(kind="cylinder", radius=0.035, length=0.16))
CARRIED = [BOX, *(Carried(HAND, np.array([sign * 0.185, 0.0, 0.09]), UPRIGHT) for sign in (-1.0, 1.0))]
START, GOAL = np.array([0.0, 0.0, 0.3]), np.array([1.4, 0.1, 0.3])
LOWER, UPPER = np.array([-3.0, -3.0, -1.0]), np.array([4.0, 3.0, 3.0])
MIDDLE = np.array([0.7, 0.25])
"""Middle of the gap [m]."""


def gap(width: float, at: FloatArray = MIDDLE) -> list[Obstacle]:
    """Return two walls with a gap across the x axis [m]."""
    walls = []
    for sign in (-1.0, 1.0):
        place = np.array([at[0], at[1] + sign * (width / 2 + 1.5), 0.8])
        walls.append(
            Obstacle(Body(f"wall {sign}", Box(kind="box", half_extents=(0.05, 1.5, 0.8))), Pose(place, UPRIGHT), 0.02)
        )
    return walls


def space_with(obstacles: list[Obstacle], most: int = 20_000) -> FreeSpace:
    """Return the free space of a box with two hands near the floor, below the top of the walls."""
    return FreeSpace(CARRIED, obstacles, lambda p: np.minimum(p[..., 2] - 0.22, 1.0 - p[..., 2]), most)


def clearance(path: FloatArray, obstacles: list[Obstacle]) -> float:
    """Return the least distance of the bodies from the walls at samples every 5 mm of a path [m]."""
    found = []
    for one, other in pairwise(path):
        for share in np.linspace(0.0, 1.0, int(np.linalg.norm(other - one) / 5e-3) + 2):
            for carried in CARRIED:
                pose = carried.at(one + share * (other - one))
                found += [find_nearest(carried.body, pose, each.body, each.pose).distance for each in obstacles]
    return min(found)


@pytest.mark.parametrize("ratio", [1.15, 1.4])
def test_a_box_goes_through_a_narrow_gap_also_with_rounded_corners(ratio: float) -> None:
    """The box is 0.28 m wide. At 1.15 times this width, 21 mm are left on each side. The usual margin is 20 mm."""
    obstacles = gap(0.28 * ratio)
    path = find_path(space_with(obstacles), START, GOAL, LOWER, UPPER, 3)
    assert path is not None
    assert np.array_equal(path[[0, -1]], [START, GOAL])
    room = 0.14 * (ratio - 1.0)
    assert clearance(round_corners(path), obstacles) > min(0.5 * room, 0.02) - 3e-3
    again = find_path(space_with(obstacles), START, GOAL, LOWER, UPPER, 3)
    assert again is not None
    assert np.array_equal(path, again)


def test_no_box_goes_through_a_gap_that_is_too_narrow() -> None:
    assert find_path(space_with(gap(0.27), most=4_000), START, GOAL, LOWER, UPPER, 3) is None


def test_the_narrowest_cell_of_the_way_is_in_the_gap() -> None:
    space = space_with(gap(0.34))
    grid = Grid(space, START, GOAL, LOWER, UPPER)
    found = grid.find_narrowest(START, GOAL)
    assert found is not None
    cell, direction = found
    assert np.abs(cell[:2] - MIDDLE).max() < 0.05 + grid.edge
    place, tight = find_widest(space, cell, direction)
    assert tight is not None
    assert space.narrowed(0.0).slack(place) == pytest.approx(0.03, abs=3e-3)
    assert space.slack(place) == pytest.approx(0.01, abs=3e-3)
    grid.close(cell, 1.0)
    assert grid.find_narrowest(START, GOAL) is None


def test_a_place_without_room_for_the_smallest_margin_is_refused() -> None:
    for spare, fits in ((4.0 * SMALLEST_MARGIN + 0.004, True), (4.0 * SMALLEST_MARGIN - 0.004, False)):
        _, tight = find_widest(space_with(gap(0.28 + spare)), np.array([*MIDDLE, 0.4]), np.array([1.0, 0.0, 0.0]))
        assert (tight is not None) == fits


def test_a_corner_close_to_a_body_is_rounded_less() -> None:
    """A right angle goes closely around the corner of a wall. Rounded by 5 cm, the path would cut this corner."""
    wall = Obstacle(Body("wall", Box(kind="box", half_extents=(0.2, 0.2, 0.5))), Pose(np.zeros(3), UPRIGHT), 0.0)
    around = 0.2 + 0.035 + 0.001
    hand = [Carried(HAND, np.zeros(3), UPRIGHT)]
    space = FreeSpace(hand, [wall], lambda p: np.full(p.shape[:-1], np.inf), 2_000)
    path = np.array([[-0.5, around, 0.0], [around, around, 0.0], [around, -0.5, 0.0]])
    refined = refine_corners(space, path)

    def least(corners: FloatArray) -> float:
        return min(space.slack(each) for each in round_corners(corners))

    assert least(path) < 0.0 < least(refined)
    assert np.array_equal(refined[[0, -1]], path[[0, -1]])
    assert len(refined) > 3
