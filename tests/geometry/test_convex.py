"""Tests of overlapping bodies, with closed forms and with PyBullet's distances."""

from pathlib import Path

import numpy as np
import pybullet
import pytest

import hybrid_tamp.geometry.overlaps as overlaps_module
from hybrid_tamp.geometry.convex import CONTACT, Body, ConvexBody, lowest_height, placed
from hybrid_tamp.geometry.overlaps import overlap, overlaps
from hybrid_tamp.geometry.shapes import Box, BoxPart, Compound, Cylinder, CylinderPart, MeshFile, Shape, Sphere
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import normalized, quaternion_from_rpy
from hybrid_tamp.taskfile.meshfile import read_mesh


def body(shape: Shape, position: tuple[float, ...] | FloatArray, orientation: FloatArray | None = None) -> Body:
    upright = np.array([0.0, 0.0, 0.0, 1.0])
    return placed(shape, np.asarray(position, dtype=float), upright if orientation is None else orientation)


CUBE = Box(kind="box", half_extents=(0.1, 0.1, 0.1))
BALL = Sphere(kind="sphere", radius=0.1)
LOG = Cylinder(kind="cylinder", radius=0.1, length=0.6)
# A cross beam on a post: the post lies along x, because the part is turned, and the beam at its end along y.
TEE = Compound(
    kind="compound",
    parts=(
        CylinderPart(kind="cylinder", radius=0.02, length=0.4, position=(0.0, 0.0, 0.0), rpy=(0.0, np.pi / 2, 0.0)),
        BoxPart(kind="box", half_extents=(0.05, 0.2, 0.05), position=(0.25, 0.0, 0.0)),
    ),
)
LYING = quaternion_from_rpy(np.array([np.pi / 2, 0.0, 0.0]))


def test_the_lowest_point() -> None:
    edge = quaternion_from_rpy(np.array([np.pi / 4, 0.0, 0.0]))
    assert lowest_height(body(CUBE, (0, 0, 0.1))) == pytest.approx(0.0)
    assert lowest_height(body(CUBE, (0, 0, 0.0), edge)) == pytest.approx(-0.1 * np.sqrt(2))
    assert lowest_height(body(LOG, (0, 0, 0.3))) == pytest.approx(0.0)
    assert lowest_height(body(LOG, (0, 0, 0.1), LYING)) == pytest.approx(0.0)
    assert lowest_height(body(BALL, (5, 5, 0.3))) == pytest.approx(0.2)


def test_a_compound_reaches_as_far_as_its_parts() -> None:
    assert lowest_height(body(TEE, (0, 0, 0.05))) == pytest.approx(0.0)
    head_down = quaternion_from_rpy(np.array([0.0, np.pi / 2, 0.0]))
    assert lowest_height(body(TEE, (1, 1, 0.3), head_down)) == pytest.approx(0.0)


def test_what_is_in_the_corner_of_a_compound_is_clear_of_it() -> None:
    corner = body(CUBE, (0.05, 0.15, 0.0))
    assert overlap(body(TEE, (0, 0, 0)), corner) is None
    in_the_beam = body(CUBE, (0.15, 0.15, 0.0))
    way = overlap(body(TEE, (0, 0, 0)), in_the_beam)
    assert way is not None
    assert overlap(body(TEE, (0, 0, 0)), body(CUBE, np.array([0.15, 0.15, 0.0]) + way)) is None
    assert overlap(in_the_beam, body(TEE, (0, 0, 0))) is not None


def test_pairs_that_pass_through_each_other_are_left_out() -> None:
    heap = [body(TEE, (0, 0, 0)), body(BALL, (0.2, 0, 0)), body(BALL, (0.25, 0, 0))]
    found = overlaps(heap, lambda earlier, later: (earlier, later) == (0, 1))
    assert [(earlier, later) for earlier, later, _ in found] == [(0, 2)]


@pytest.mark.parametrize("shape", [CUBE, BALL, LOG])
def test_the_way_out_is_the_depth(shape: Shape) -> None:
    way = overlap(body(CUBE, (0, 0, 0)), body(shape, (0.15, 0, 0)))
    np.testing.assert_allclose(way, [0.05, 0, 0], atol=1e-12)


def test_touching_is_no_overlap() -> None:
    assert overlap(body(CUBE, (0, 0, 0)), body(CUBE, (0.2, 0, 0))) is None
    assert overlap(body(CUBE, (0, 0, 0)), body(CUBE, (0.2 - 0.9 * CONTACT, 0, 0))) is None
    assert overlap(body(CUBE, (0, 0, 0)), body(CUBE, (0.2 - 1.1 * CONTACT, 0, 0))) is not None


def test_two_bodies_at_one_place_overlap() -> None:
    for shape in (CUBE, BALL, LOG):
        assert overlap(body(shape, (1, 2, 3)), body(shape, (1, 2, 3))) is not None


def test_each_body_that_overlaps_an_earlier_one_comes_once() -> None:
    row = [body(CUBE, (0.15 * number, 0, 0)) for number in range(4)]
    assert [(earlier, later) for earlier, later, _ in overlaps(row)] == [(0, 1), (1, 2), (2, 3)]
    heap = [body(CUBE, (0.01 * number, 0, 0)) for number in range(4)]
    assert [(earlier, later) for earlier, later, _ in overlaps(heap)] == [(0, 1), (0, 2), (0, 3)]


def random_shape(rng: np.random.Generator) -> tuple[Shape, int]:
    kind, (x, y, z) = rng.integers(3), map(float, rng.uniform(0.02, 0.3, 3))
    if kind == 0:
        shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=(x, y, z))
        return Box(kind="box", half_extents=(x, y, z)), shape
    if kind == 1:
        shape = pybullet.createCollisionShape(pybullet.GEOM_CYLINDER, radius=x, height=y)
        return Cylinder(kind="cylinder", radius=x, length=y), shape
    return Sphere(kind="sphere", radius=x), pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=x)


def test_pybullet_finds_the_same_pairs_and_no_longer_way_out() -> None:
    client = pybullet.connect(pybullet.DIRECT)
    rng, hits = np.random.default_rng(7), 0
    try:
        for _ in range(400):
            poses = [(rng.uniform(-0.25, 0.25, 3), normalized(rng.normal(size=4))) for _ in range(2)]
            shapes = [random_shape(rng) for _ in range(2)]
            handles = [
                pybullet.createMultiBody(0, shape, -1, *pose) for (_, shape), pose in zip(shapes, poses, strict=True)
            ]
            gap = min(point[8] for point in pybullet.getClosestPoints(*handles, 10.0))
            one, other = (body(shape, *pose) for (shape, _), pose in zip(shapes, poses, strict=True))
            way = overlap(one, other)
            if abs(gap + CONTACT) > CONTACT:
                assert (way is not None) == (gap < -CONTACT)
            if way is not None:
                hits += 1
                assert np.linalg.norm(way) >= -gap - 1e-6
                assert overlap(one, body(shapes[1][0], poses[1][0] + way, poses[1][1])) is None
    finally:
        pybullet.disconnect(client)
    assert 50 < hits < 350


def grid(count: int, size: float) -> Shape:
    """Return a cube that consists of ``count ** 3`` boxes with edges of the length `size`."""
    half = size / count / 2
    places = [(-size / 2 + half + 2 * half * np.array(cell)).tolist() for cell in np.ndindex(count, count, count)]
    boxes = [BoxPart(kind="box", half_extents=(half, half, half), position=tuple(place)) for place in places]
    return Compound(kind="compound", parts=tuple(boxes))


def test_bodies_of_many_solids_take_few_exact_tests(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[ConvexBody] = []
    exact = overlaps_module._overlap
    monkeypatch.setattr(overlaps_module, "_overlap", lambda one, other: (asked.append(one), exact(one, other))[1])
    many = grid(6, 0.6)
    assert overlap(body(many, (0, 0, 0)), body(many, (0.601, 0, 0))) is None
    assert asked == []
    way = overlap(body(many, (0, 0, 0)), body(many, (0.58, 0.01, 0)))
    assert way == pytest.approx([0.02, 0, 0])
    assert len(asked) == 1


def test_extents_are_those_of_the_support_points() -> None:
    rng = np.random.default_rng(5)
    directions = rng.normal(size=(40, 3))
    for shape in (CUBE, BALL, LOG, TEE):
        for part in body(shape, rng.normal(size=3), normalized(rng.normal(size=4))):
            assert part.extents(directions) == pytest.approx([part.support(each) @ each for each in directions])


def test_a_box_from_a_mesh_is_that_box() -> None:
    path = Path(__file__).parents[2] / "problems" / "meshes" / "box.obj"
    mesh, box = read_mesh(path, MeshFile(kind="mesh", file="b")), Box(kind="box", half_extents=(0.15, 0.14, 0.165))
    rng = np.random.default_rng(4)
    for _ in range(20):
        turn, place, direction = normalized(rng.normal(size=4)), rng.normal(size=3), rng.normal(size=3)
        (one,), (other,) = body(mesh, place, turn), body(box, place, turn)
        assert one.extents(direction[None]) == pytest.approx(other.extents(direction[None]), abs=1e-6)
        assert one.support(direction) == pytest.approx(other.support(direction), abs=1e-7)
        assert one.shrunk(0.01).support(direction) == pytest.approx(other.shrunk(0.01).support(direction), abs=1e-7)


@pytest.mark.parametrize("shape", [CUBE, BALL, LOG, TEE], ids=["cube", "ball", "log", "tee"])
def test_furthest_points_along_many_directions_equal_those_along_single_directions(shape: Shape) -> None:
    rng = np.random.default_rng(5)
    directions = np.vstack([rng.normal(size=(20, 3)), np.eye(3)])
    for solid in body(shape, rng.normal(size=3), quaternion_from_rpy(rng.uniform(-1.0, 1.0, 3))):
        assert solid.supports(directions) == pytest.approx(np.array([solid.support(each) for each in directions]))
