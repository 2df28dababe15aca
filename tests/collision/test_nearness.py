"""Whether movements may come near bodies, compared with exact distances at many poses."""

import numpy as np
import pytest

from hybrid_tamp.collision.bodies import Body, find_nearest
from hybrid_tamp.collision.deviations import find_deviation
from hybrid_tamp.collision.nearness import find_parted, may_come_near
from hybrid_tamp.collision.sweeps import Track
from hybrid_tamp.geometry.shapes import Box, Cylinder, Shape
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import normalized, quaternion_from_axis_angle

HAND = Cylinder(kind="cylinder", radius=0.035, length=0.16)
CRATE = Box(kind="box", half_extents=(0.1, 0.15, 0.2))
UPRIGHT = np.array([[0.0, 0.0, 0.0, 1.0]])


def make_track(name: str, shape: Shape, positions: FloatArray, orientations: FloatArray = UPRIGHT) -> Track:
    return Track(Body(name, shape), positions, np.broadcast_to(orientations, (len(positions), 4)))


def wander(name: str, shape: Shape, rng: np.random.Generator, around: FloatArray, poses: int = 4) -> Track:
    positions = around + rng.uniform(-0.6, 0.6, (poses, 3))
    return make_track(name, shape, positions, normalized(rng.normal(size=(poses, 4))))


def sample_distance(one: Track, other: Track) -> float:
    """Return the least distance of two bodies at any two of many phases [m]."""
    phases = [
        np.linspace(0.0, len(track.positions) - 1.0, 40 if len(track.positions) > 1 else 1) for track in (one, other)
    ]
    return min(
        find_nearest(one.body, one.at(mine), other.body, other.at(theirs)).distance
        for mine in phases[0]
        for theirs in phases[1]
    )


@pytest.mark.parametrize("poses", [1, 3])
@pytest.mark.parametrize("seed", range(6))
def test_no_movement_near_a_body_is_missed(seed: int, poses: int) -> None:
    """A body at rest has one pose. Other bodies may be at any phase of their movement."""
    rng = np.random.default_rng(seed)
    one, other = wander("hand", HAND, rng, np.zeros(3)), wander("crate", CRATE, rng, np.array([1.0, 0.0, 0.0]), poses)
    least = sample_distance(one, other)
    assert may_come_near(one, other, least + 1e-4)
    if least > 0.02:
        assert not may_come_near(one, other, 0.7 * least - 0.01)


def test_a_thin_wall_between_two_poses_is_found() -> None:
    wall = make_track("wall", Box(kind="box", half_extents=(0.0005, 1.0, 1.0)), np.zeros((1, 3)))
    through = make_track("hand", HAND, np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))
    beside = make_track("hand", HAND, np.array([[-1.0, 0.0, 0.0], [-0.1, 0.0, 0.0]]))
    assert may_come_near(through, wall, 0.0)
    assert not may_come_near(beside, wall, 0.02)


def test_a_hand_that_touches_a_crate_parts_from_it_or_moves_into_it() -> None:
    crate = make_track("crate", CRATE, np.zeros((1, 3)))
    steps = np.linspace(0.0, 0.1, 11)[:, None]
    away, into, along = np.array([1.0, 0.0, 0.0]), np.array([-1.0, 0.0, 0.0]), np.array([0.0, 0.3, 0.0])
    touching = np.array([0.1 + 0.035, 0.0, 0.0])
    assert find_parted(make_track("hand", HAND, touching + steps * away), crate, 0.007) == 1
    assert find_parted(make_track("hand", HAND, touching + steps * into), crate, 0.007) == -1
    assert find_parted(make_track("hand", HAND, touching + steps * along), crate, 0.007) == -1
    assert find_parted(make_track("hand", HAND, touching + 0.05 * away + steps * along), crate, 0.007) == 0


def test_the_deviation_counts_the_nearest_pose_and_the_turn() -> None:
    corner = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]])
    wanted = make_track("crate", CRATE, corner)
    turned = quaternion_from_axis_angle(np.array([0.0, 0.0, 1.0]), np.array(0.1))
    assert find_deviation(make_track("crate", CRATE, corner[1:2] * 0.5), wanted) == pytest.approx(0.0, abs=0.01)
    beside = make_track("crate", CRATE, np.array([[0.4, 0.03, 0.0]]))
    assert find_deviation(beside, wanted) == pytest.approx(0.03, abs=1e-3)
    still = make_track("crate", CRATE, np.zeros((1, 3)))
    there = make_track("crate", CRATE, np.zeros((1, 3)), turned)
    assert find_deviation(there, still) == pytest.approx(0.1 * there.body.reach, rel=1e-3)


def test_a_cylinder_may_turn_about_its_axis() -> None:
    turned = quaternion_from_axis_angle(np.array([0.0, 0.0, 1.0]), np.array(1.5))
    still = make_track("hand", HAND, np.zeros((1, 3)))
    assert find_deviation(make_track("hand", HAND, np.zeros((1, 3)), turned), still) == pytest.approx(0.0, abs=1e-6)
