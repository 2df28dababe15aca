"""Points near bodies agree with the exact distance, or err on the safe side."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hybrid_tamp.geometry.convex import placed
from hybrid_tamp.geometry.gaps import distance_to_point
from hybrid_tamp.geometry.nearness import inner_balls, inner_radius, surely_within
from hybrid_tamp.geometry.shapes import Box, BoxPart, Compound, Cylinder, MeshFile, Shape, Sphere
from hybrid_tamp.motion.poses import normalized
from hybrid_tamp.taskfile.meshfile import read_mesh

MESHES = Path(__file__).resolve().parent.parent.parent / "problems" / "meshes"
PLAIN: list[Shape] = [
    Box(kind="box", half_extents=(0.1, 0.2, 0.05)),
    Cylinder(kind="cylinder", radius=0.1, length=0.3),
    Sphere(kind="sphere", radius=0.15),
]


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(PLAIN), st.lists(st.floats(-1.0, 1.0), min_size=10, max_size=10), st.floats(0.0, 0.3))
def test_plain_shapes_are_exact(shape: Shape, drawn: list[float], distance: float) -> None:
    numbers = np.array(drawn)
    turn = normalized(numbers[:4] + np.array([0.0, 0.0, 0.0, 2.0]))
    (body,) = placed(shape, numbers[4:7], turn)
    point = numbers[7:]
    exact = distance_to_point(body, point)
    if abs(exact - distance) > 1e-6:
        assert surely_within(body, point[None], distance)[0] == (exact < distance)


def test_a_point_that_is_almost_the_centre_of_a_sphere_is_within() -> None:
    (ball,) = placed(PLAIN[2], np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))
    assert distance_to_point(ball, np.array([0.0, 0.0, 6.7e-163])) == 0.0


def test_no_point_is_within_a_negative_distance() -> None:
    (body,) = placed(PLAIN[0], np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))
    assert not surely_within(body, np.zeros((1, 3)), -0.01)[0]


def test_points_of_hulls_that_count_as_near_are_near() -> None:
    mesh = read_mesh(MESHES / "prism8.obj", MeshFile(kind="mesh", file="prism8.obj"))
    points = np.random.default_rng(0).uniform(-0.4, 0.4, (200, 3))
    found = 0
    for body in placed(mesh, np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0])):
        for point, near in zip(points, surely_within(body, points, 0.05), strict=True):
            found += bool(near)
            assert not near or distance_to_point(body, point) <= 0.05 + 1e-6
    assert found > 5


@pytest.mark.parametrize(("shape", "radius"), list(zip(PLAIN, (0.05, 0.1, 0.15), strict=True)))
def test_the_largest_ball_within_plain_shapes(shape: Shape, radius: float) -> None:
    assert inner_radius(shape) == pytest.approx(radius)


def test_a_shape_whose_origin_is_outside_contains_no_ball() -> None:
    part = BoxPart(kind="box", half_extents=(0.1, 0.1, 0.1), position=(0.3, 0.0, 0.0))
    assert inner_radius(Compound(kind="compound", parts=(part,))) == 0.0


@pytest.mark.parametrize("shape", PLAIN)
def test_balls_within_a_shape_do_not_leave_it(shape: Shape) -> None:
    (body,) = placed(shape, np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))
    directions = normalized(np.random.default_rng(1).normal(size=(200, 3)))
    for centre, radius in inner_balls(shape):
        assert surely_within(body, centre + 0.999 * radius * directions, 0.0).all()
