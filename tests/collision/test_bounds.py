"""Lower bounds of distances at many poses, compared with distances of the library python-fcl."""

from itertools import product

import numpy as np
import pytest

from hybrid_tamp.collision.bodies import Body, Pose, find_nearest
from hybrid_tamp.collision.bounds import Poses, bound_distances
from hybrid_tamp.geometry.shapes import Box, BoxPart, Compound, Cylinder, Shape, Sphere
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import normalized

SHAPES: dict[str, Shape] = {
    "box": Box(kind="box", half_extents=(0.1, 0.2, 0.05)),
    "drum": Cylinder(kind="cylinder", radius=0.1, length=0.3),
    "ball": Sphere(kind="sphere", radius=0.08),
    "tray": Compound(
        kind="compound",
        parts=(
            BoxPart(kind="box", half_extents=(0.2, 0.15, 0.01), position=(0.0, 0.0, -0.05)),
            BoxPart(kind="box", half_extents=(0.01, 0.15, 0.05), position=(0.19, 0.0, 0.01)),
        ),
    ),
}
COUNT = 80


def compare(one: Shape, other: Shape) -> tuple[FloatArray, FloatArray]:
    """Return bounds and distances, each ``(n,)`` [m], at random poses near each other."""
    rng = np.random.default_rng(1)
    places, turns = rng.uniform(-0.35, 0.35, (2, COUNT, 3)), normalized(rng.normal(size=(2, COUNT, 4)))
    bounds = bound_distances(one, Poses(places[0], turns[0]), other, Poses(places[1], turns[1]))
    mine, theirs = Body("one", one), Body("other", other)
    poses = [[Pose(place, turn) for place, turn in zip(*each, strict=True)] for each in zip(places, turns, strict=True)]
    exact = [find_nearest(mine, at, theirs, there).distance for at, there in zip(*poses, strict=True)]
    return bounds, np.array(exact)


@pytest.mark.parametrize(("one", "other"), list(product(SHAPES, SHAPES)))
def test_the_bounds_are_never_above_the_distances_and_seldom_far_below(one: str, other: str) -> None:
    bounds, exact = compare(SHAPES[one], SHAPES[other])
    apart = exact > 0.0
    assert np.all(bounds[apart] <= exact[apart] + 1e-5)
    assert np.all(bounds[exact < -5e-3] < 0.0)
    near = apart & (exact < 0.03)
    assert np.median(exact[near] - bounds[near]) < 2e-3


def test_a_pose_has_the_same_bound_alone_and_among_others() -> None:
    rng = np.random.default_rng(2)
    at = Poses(rng.uniform(-0.2, 0.2, (30, 3)), normalized(rng.normal(size=(30, 4))))
    there = Poses(np.zeros((30, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (30, 1)))
    whole = bound_distances(SHAPES["drum"], at, SHAPES["tray"], there)
    alone = [bound_distances(SHAPES["drum"], at.at([row]), SHAPES["tray"], there.at([row]))[0] for row in range(30)]
    assert np.allclose(whole, alone, rtol=0.0, atol=1e-12)


def test_parallel_boxes_have_exact_bounds() -> None:
    box, upright = SHAPES["box"], np.array([[0.0, 0.0, 0.0, 1.0]])
    there = Poses(np.zeros((1, 3)), upright)
    for place, distance in (((0.21, 0.0, 0.0), 0.01), ((0.0, 0.0, 0.09), -0.01), ((0.0, 0.4, 0.0), 0.0)):
        bound = bound_distances(box, Poses(np.array([place]), upright), box, there)
        assert bound[0] == pytest.approx(distance, abs=1e-9)
