"""Common volumes and gaps of convex solids, compared with closed forms and with random points."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hybrid_tamp.geometry.common_volume import common_volume, face_planes
from hybrid_tamp.geometry.convex import placed
from hybrid_tamp.geometry.gaps import distance_between, distance_to_point, find_gap
from hybrid_tamp.geometry.shapes import Box, Cylinder, Shape, Sphere
from hybrid_tamp.geometry.surfaces import hulls_of
from hybrid_tamp.motion.poses import normalized

WHOLE = np.array([0.0, 0.0, 0.0, 1.0])


def box(*halves: float) -> Box:
    x, y, z = halves
    return Box(kind="box", half_extents=(x, y, z))


@given(st.tuples(*[st.floats(0.05, 1.0)] * 6), st.tuples(*[st.floats(-1.0, 1.0)] * 3))
@settings(max_examples=60, deadline=None)
def test_boxes_along_the_axes(halves: tuple[float, ...], way: tuple[float, float, float]) -> None:
    one, other = (hulls_of(box(*each))[0] for each in (halves[:3], halves[3:]))
    shared = np.minimum(halves[:3], np.array(way) + halves[3:]) - np.maximum(
        -np.array(halves[:3]), np.array(way) - halves[3:]
    )
    expected = float(np.prod(np.maximum(shared, 0.0)))
    found = common_volume(face_planes(one), face_planes(other.moved(np.array(way))))
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-8)


@pytest.mark.parametrize("seed", range(6))
def test_turned_solids_agree_with_random_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shapes: list[Shape] = [box(0.3, 0.2, 0.25), Cylinder(kind="cylinder", radius=0.2, length=0.5)]
    one, other = (hulls_of(shape)[0] for shape in shapes)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    other = type(other)(other.vertices @ turn.T + rng.uniform(-0.15, 0.15, 3), other.triangles)
    points = rng.uniform(-0.3, 0.3, (200_000, 3))
    inside = [np.all(points @ planes[:, :3].T + planes[:, 3] <= 0, axis=1) for planes in map(face_planes, (one, other))]
    expected = float(np.mean(inside[0] & inside[1])) * 0.6**3
    assert common_volume(face_planes(one), face_planes(other)) == pytest.approx(expected, rel=0.03)


def test_distances_of_round_and_turned_bodies() -> None:
    ball = Sphere(kind="sphere", radius=0.1)
    (one,) = placed(ball, np.zeros(3), WHOLE)
    (other,) = placed(ball, np.array([0.3, 0.4, 0.0]), WHOLE)
    assert distance_between(one, other) == pytest.approx(0.3, abs=1e-6)
    (upright,) = placed(Cylinder(kind="cylinder", radius=0.1, length=0.4), np.array([0.5, 0.0, 0.35]), WHOLE)
    assert distance_between(one, upright) == pytest.approx(np.hypot(0.4, 0.15) - 0.1, abs=1e-6)
    (tipped,) = placed(box(0.1, 0.1, 0.1), np.array([0.5, 0.0, 0.0]), normalized((0.0, 0.0, 0.3826834, 0.9238795)))
    assert distance_between(one, tipped) == pytest.approx(0.4 - 0.1 * np.sqrt(2), abs=1e-6)
    assert distance_between(tipped, tipped) == 0.0
    assert distance_to_point(tipped, np.array([0.5, 0.0, 0.3])) == pytest.approx(0.2)
    assert distance_to_point(tipped, np.array([0.55, 0.0, 0.05])) == 0.0


@pytest.mark.parametrize("seed", range(5))
def test_a_chain_is_connected_and_a_broken_chain_is_not(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turns = normalized(rng.normal(size=(12, 4)))
    places = (
        np.cumsum(0.15 * normalized(rng.normal(size=(12, 3))), axis=0) + np.array([0.12, 0, 0]) * np.arange(12)[:, None]
    )
    chain = [
        placed(Sphere(kind="sphere", radius=0.16), place, turn)[0] for place, turn in zip(places, turns, strict=True)
    ]
    order = rng.permutation(12)
    assert find_gap([chain[i] for i in order], 1e-3) is None
    far = placed(Sphere(kind="sphere", radius=0.16), places[-1] + np.array([2.0, 0.0, 0.0]), WHOLE)[0]
    gap = find_gap([*(chain[i] for i in order), far], 1e-3)
    assert gap is not None
    assert gap.other == 12
    assert gap.width == pytest.approx(
        min(float(np.linalg.norm(far.position - part.position)) for part in chain) - 0.32, abs=1e-6
    )
