"""Least distances during movements, compared with dense samples."""

import numpy as np
import pytest

from hybrid_tamp.collision.bodies import Body, Pose, find_nearest
from hybrid_tamp.collision.sweeps import FLOOR, Track, find_clearance
from hybrid_tamp.geometry.shapes import Box, Cylinder
from hybrid_tamp.motion.poses import quaternion_from_rpy

UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])
HAND = Body("hand", Cylinder(kind="cylinder", radius=0.035, length=0.16))
CRATE = Body("crate", Box(kind="box", half_extents=(0.3, 0.28, 0.36)))


def straight(body: Body, begin: list[float], end: list[float]) -> Track:
    return Track(body, np.array([begin, end]), np.array([UPRIGHT, UPRIGHT]))


def at(*place: float) -> Pose:
    return Pose(np.array(place), UPRIGHT)


def test_a_hand_that_passes_a_crate() -> None:
    track = straight(HAND, [-1.0, 0.4, 0.5], [1.0, 0.4, 0.5])
    found = find_clearance([track], [(CRATE, at(0.0, 0.0, 0.36))])
    assert found is not None
    assert found.distance == pytest.approx(0.4 - 0.035 - 0.28, abs=2e-3)
    assert (found.moving, found.other) == ("hand", "crate")
    assert 0.3 < found.phase < 0.7


def test_a_thin_wall_is_not_missed_between_two_poses() -> None:
    wall = Body("wall", Box(kind="box", half_extents=(0.0025, 0.5, 0.5)))
    track = straight(HAND, [-3.0, 0.0, 0.3], [5.0, 0.0, 0.3])
    found = find_clearance([track], [(wall, at(0.123, 0.0, 0.5))])
    assert found is not None
    assert found.distance < 0
    assert found.phase * 8.0 - 3.0 == pytest.approx(0.123, abs=0.05)


def test_bodies_beyond_the_limit_are_left_out() -> None:
    track = straight(HAND, [-1.0, 0.0, 1.5], [1.0, 0.0, 1.5])
    crate = [(CRATE, at(0.0, 0.0, 0.36))]
    assert find_clearance([track], crate, limit=0.5) is None
    assert find_clearance([track], crate, limit=0.8) is not None


def test_the_floor_counts_if_wanted() -> None:
    track = straight(HAND, [0.0, 0.0, 0.5], [1.0, 0.0, 0.1])
    found = find_clearance([track], [], floor=True)
    assert found is not None
    assert (found.other, found.phase) == (FLOOR, 1.0)
    assert found.distance == pytest.approx(0.02)


@pytest.mark.parametrize("seed", range(12))
def test_the_least_distance_of_a_turning_body_agrees_with_dense_samples(seed: int) -> None:
    rng = np.random.default_rng(seed)
    positions = rng.uniform(-1.0, 1.0, (4, 3))
    orientations = np.array([quaternion_from_rpy(rng.uniform(-1.5, 1.5, 3)) for _ in positions])
    track = Track(CRATE, positions, orientations)
    obstacles = [
        (
            Body(f"box {i}", Box(kind="box", half_extents=tuple(rng.uniform(0.05, 0.2, 3)))),
            Pose(rng.uniform(-2, 2, 3), UPRIGHT),
        )
        for i in range(4)
    ]
    samples = [
        find_nearest(CRATE, track.at(phase), *obstacle).distance
        for phase in np.linspace(0.0, 3.0, 1501)
        for obstacle in obstacles
    ]
    found = find_clearance([track], obstacles, precision=1e-3)
    assert found is not None
    assert min(samples) - 4e-3 <= found.distance <= min(samples) + 2e-3
