"""Distances of bodies, compared with closed forms."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hybrid_tamp.collision.bodies import Body, Pose, bound_distance, find_nearest
from hybrid_tamp.collision.cores import CORNER_ERROR
from hybrid_tamp.geometry.meshes import MeshShape
from hybrid_tamp.geometry.shapes import Box, BoxPart, Compound, Cylinder, Sphere
from hybrid_tamp.geometry.surfaces import hulls_of
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rpy, quaternion_multiply, rotate

UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])
LYING = quaternion_from_rpy((np.pi / 2, 0.0, 0.0))
numbers = st.floats(-2.0, 2.0)
places = st.tuples(numbers, numbers, numbers).map(np.array)
turns = st.tuples(*(st.floats(-3.1, 3.1),) * 3).map(quaternion_from_rpy)


def ball(radius: float) -> Body:
    return Body("ball", Sphere(kind="sphere", radius=radius))


def box(*half: float) -> Body:
    return Body("box", Box(kind="box", half_extents=half))  # type: ignore[arg-type]


def drum(radius: float = 0.1, length: float = 0.3) -> Body:
    return Body("drum", Cylinder(kind="cylinder", radius=radius, length=length))


def distance(one: Body, at: Pose, other: Body, there: Pose) -> float:
    return find_nearest(one, at, other, there).distance


@given(places, places)
def test_two_balls(one: FloatArray, other: FloatArray) -> None:
    found = distance(ball(0.2), Pose(one, UPRIGHT), ball(0.3), Pose(other, UPRIGHT))
    exact = float(np.linalg.norm(one - other)) - 0.5
    assert found == pytest.approx(max(exact, -0.49), abs=1e-5)


@given(places, places, turns)
def test_a_ball_outside_a_box(centre: FloatArray, place: FloatArray, turn: FloatArray) -> None:
    half = np.array([0.3, 0.2, 0.1])
    local = rotate(turn * [-1, -1, -1, 1], centre - place)
    outside = float(np.linalg.norm(np.maximum(np.abs(local) - half, 0.0)))
    found = distance(ball(0.1), Pose(centre, UPRIGHT), box(*half), Pose(place, turn))
    if outside > 0.1:
        assert outside - 0.1 - 1e-5 <= found <= outside - 0.1 + CORNER_ERROR + 1e-5


@pytest.mark.parametrize("depth", [0.03, 0.1, 0.15])
def test_a_box_in_a_box_has_a_negative_distance(depth: float) -> None:
    found = distance(
        box(0.2, 0.2, 0.2), Pose(np.zeros(3), UPRIGHT), box(0.3, 0.3, 0.3), Pose(np.array([0.5 - depth, 0, 0]), UPRIGHT)
    )
    assert found == pytest.approx(-depth, abs=1e-4)


@pytest.mark.parametrize("yaw", np.linspace(0.0, np.pi, 7))
@pytest.mark.parametrize("x", [0.0, 0.05, 0.5])
def test_bodies_rest_on_a_slab_without_overlap(x: float, yaw: float) -> None:
    """In these poses, requests for signed distances of whole bodies are wrong, or end the process."""
    slab, there = box(5.0, 5.0, 0.05), Pose(np.array([0.0, 0.0, -0.05]), UPRIGHT)
    turn = quaternion_from_rpy((0.0, 0.0, yaw))
    for body, height, lean in ((drum(), 0.1, LYING), (drum(), 0.15, UPRIGHT), (box(0.1, 0.2, 0.3), 0.3, UPRIGHT)):
        pose = Pose(np.array([x, x, height]), quaternion_multiply(turn, lean))
        assert distance(body, pose, slab, there) == pytest.approx(0.0, abs=1e-4)
        assert distance(slab, there, body, pose) == pytest.approx(0.0, abs=1e-4)
        assert body.height(pose) == pytest.approx(0.0, abs=1e-9)


def test_the_nearest_part_of_a_compound_counts() -> None:
    parts = tuple(BoxPart(kind="box", half_extents=(0.1, 0.1, 0.1), position=(x, 0.0, 0.0)) for x in (-0.5, 0.5))
    table = Body("table", Compound(kind="compound", parts=parts))
    found = distance(table, Pose(np.zeros(3), UPRIGHT), ball(0.1), Pose(np.array([1.0, 0.0, 0.0]), UPRIGHT))
    assert found == pytest.approx(0.3, abs=1e-5)


@given(places, turns, places, turns)
def test_the_distance_of_the_balls_around_two_bodies_is_a_lower_bound(
    one: FloatArray, turn: FloatArray, other: FloatArray, another: FloatArray
) -> None:
    bodies = (drum(), Pose(one, turn), box(0.1, 0.2, 0.3), Pose(other, another))
    assert bound_distance(*bodies) <= distance(*bodies) + 1e-3


def test_a_mesh_is_a_solid_body() -> None:
    """Its single part is a cube, so its distances are those of a box, also inside."""
    cube = hulls_of(Box(kind="box", half_extents=(0.2, 0.2, 0.2)))
    mesh = Body("mesh", MeshShape.of(Path("cube.obj"), 1.0, "", cube))
    for x, exact in ((0.5, 0.2), (0.3, 0.0), (0.2, -0.1)):
        found = distance(mesh, Pose(np.zeros(3), UPRIGHT), ball(0.1), Pose(np.array([x, 0.0, 0.0]), UPRIGHT))
        assert found == pytest.approx(exact, abs=2e-3)
