"""The least distance from several bodies, compared with dense samples."""

import numpy as np
import pytest

from hybrid_tamp.collision.bodies import Body, Pose, find_nearest
from hybrid_tamp.collision.closest import find_closest
from hybrid_tamp.collision.sweeps import PRECISION, Track, find_clearance
from hybrid_tamp.geometry.shapes import Box, Cylinder
from hybrid_tamp.motion.poses import quaternion_from_axis_angle, quaternion_from_rpy, quaternion_multiply

UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])
DRUM = Cylinder(kind="cylinder", radius=0.1, length=0.3)
CRATE = Box(kind="box", half_extents=(0.3, 0.28, 0.36))


@pytest.mark.parametrize("seed", range(8))
def test_the_closest_body_agrees_with_dense_samples(seed: int) -> None:
    rng = np.random.default_rng(seed)
    positions = rng.uniform(-1.5, 1.5, (4, 3))
    track = Track(Body("drum", DRUM), positions, quaternion_from_rpy(rng.uniform(-1.0, 1.0, (4, 3))))
    others = [
        (Body(f"crate-{number}", CRATE), Pose(rng.uniform(-1.5, 1.5, 3), quaternion_from_rpy(rng.uniform(-3, 3, 3))))
        for number in range(4)
    ]
    found = find_closest(track, others)
    assert found is not None
    sampled = min(
        find_nearest(track.body, track.at(phase), *other).distance
        for phase in np.linspace(0.0, 3.0, 200).tolist()
        for other in others
    )
    single = [each for each in others if each[0].name == found.other]
    exact = find_clearance([track], single, precision=1e-5)
    assert exact is not None
    assert found.distance <= exact.distance + PRECISION + 1e-5
    if sampled > 0:
        assert sampled - max(2e-3, 0.06 * sampled) <= found.distance <= sampled + max(1e-3, 0.05 * sampled)
    else:
        assert found.distance < 0
    (there,) = (pose for body, pose in others if body.name == found.other)
    (body,) = (body for body, _ in others if body.name == found.other)
    assert find_nearest(track.body, track.at(found.phase), body, there).distance == found.distance


def test_bodies_beyond_the_limit_are_left_out() -> None:
    track = Track(Body("drum", DRUM), np.array([[-1.0, 0.0, 1.5], [1.0, 0.0, 1.5]]), np.array([UPRIGHT, UPRIGHT]))
    crate = [(Body("crate", CRATE), Pose(np.array([0.0, 0.0, 0.36]), UPRIGHT))]
    assert find_closest(track, crate, limit=0.5) is None
    assert find_closest(track, crate, limit=0.7) is not None
    assert find_closest(track, [], limit=0.7) is None


def test_a_turn_of_a_cylinder_about_its_axis_moves_nothing() -> None:
    lying = quaternion_from_rpy(np.array([np.pi / 2, 0.0, 0.0]))
    spun = quaternion_multiply(lying, quaternion_from_axis_angle(np.array([0.0, 0.0, 1.0]), 1.0))
    tipped = quaternion_multiply(lying, quaternion_from_axis_angle(np.array([1.0, 0.0, 0.0]), 1.0))
    here = np.zeros((2, 3))
    drum, crate = Body("drum", DRUM), Body("crate", CRATE)
    assert Track(drum, here, np.array([lying, spun])).bound(0.0, 1.0) == pytest.approx(0.0, abs=1e-9)
    assert Track(drum, here, np.array([lying, tipped])).bound(0.0, 1.0) == pytest.approx(drum.reach)
    assert Track(crate, here, np.array([lying, spun])).bound(0.0, 1.0) == pytest.approx(crate.reach)


@pytest.mark.parametrize("seed", range(20))
def test_no_distance_changes_faster_than_the_bound_of_a_turning_drum(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turns = quaternion_from_rpy(rng.uniform(-2.0, 2.0, (2, 3)))
    track = Track(Body("drum", DRUM), rng.uniform(-0.3, 0.3, (2, 3)), turns)
    crate = Body("crate", CRATE), Pose(np.array([1.0, 0.5, 0.2]), quaternion_from_rpy(rng.uniform(-2.0, 2.0, 3)))
    phases = np.linspace(0.0, 1.0, 30).tolist()
    distances = [find_nearest(track.body, track.at(phase), *crate).distance for phase in phases]
    for one, other, begin, end in zip(distances, distances[1:], phases, phases[1:], strict=False):
        # Corners are rounded by the layers of the cores.
        assert abs(one - other) <= track.bound(begin, end) + 1e-3
