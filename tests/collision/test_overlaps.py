"""Certain overlaps are overlaps, and a set of offsets is covered only if each of its offsets is."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hybrid_tamp.collision.bodies import Body, Pose
from hybrid_tamp.collision.overlaps import Margins, Obstruction, convex_solids, overlaps_everywhere
from hybrid_tamp.geometry.convex import placed
from hybrid_tamp.geometry.gaps import distance_between
from hybrid_tamp.geometry.shapes import Box, Cylinder, Shape
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rpy

CRATE = Box(kind="box", half_extents=(0.15, 0.14, 0.12))
HAND = Cylinder(kind="cylinder", radius=0.035, length=0.16)
TURNS = st.tuples(*[st.floats(-3.1, 3.1)] * 3)
PLACES = st.tuples(*[st.floats(-0.3, 0.3)] * 3)


def obstruction(shape: Shape, wall: Box, place: FloatArray, turn: FloatArray, within: float = 0.0) -> Obstruction:
    pose = Pose(place, turn)
    walls = {"wall": convex_solids(Body("wall", wall), Pose(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0])))}
    return Obstruction("thing", convex_solids(Body("thing", shape), pose), walls, within)


@settings(max_examples=60)
@given(st.sampled_from([CRATE, HAND]), PLACES, TURNS, PLACES, st.floats(0.0, 0.1))
def test_an_overlap_that_is_certain_remains_after_a_short_offset(
    shape: Shape, place: tuple[float, ...], turn: tuple[float, ...], way: tuple[float, ...], length: float
) -> None:
    wall, turned = Box(kind="box", half_extents=(0.1, 0.1, 0.2)), quaternion_from_rpy(np.array(turn))
    if obstruction(shape, wall, np.array(place), turned).find(np.zeros(3), at_least=length) is None:
        return
    offset = np.array(way) / max(float(np.linalg.norm(way)), 1e-9) * length
    (thing,), (other,) = placed(shape, np.array(place) + offset, turned), placed(wall, np.zeros(3), np.eye(4)[3])
    assert distance_between(thing, other) <= 1e-6


def disc(radius: float) -> Margins:
    return lambda offsets: radius - np.linalg.norm(offsets[:, :2], axis=1)


@pytest.mark.parametrize(
    ("half", "admits", "covered"),
    [
        (0.10, disc(0.05), True),
        (0.02, disc(0.12), True),  # The crate is wider than the disc.
        (0.02, disc(0.22), False),  # At its edge, the crate stands beside the post.
        (5.00, lambda offsets: np.full(len(offsets), 1.0), False),  # Nothing is known about far offsets.
    ],
)
def test_offsets_are_covered_only_if_the_body_overlaps_at_all_of_them(
    half: float, admits: Callable[[FloatArray], FloatArray], covered: bool
) -> None:
    wall = Box(kind="box", half_extents=(half, half, 0.3))
    assert overlaps_everywhere([obstruction(CRATE, wall, np.zeros(3), np.eye(4)[3])], admits) == covered


def test_a_body_that_may_be_elsewhere_overlaps_only_if_it_overlaps_deeper() -> None:
    wall, place = Box(kind="box", half_extents=(0.1, 0.1, 0.3)), np.array([0.23, 0.0, 0.0])
    near = obstruction(CRATE, wall, place, np.eye(4)[3], within=0.005).find(np.zeros(3))
    assert near is not None
    assert near.depth == pytest.approx(0.02, abs=2e-3)
    assert obstruction(CRATE, wall, place, np.eye(4)[3], within=0.02).find(np.zeros(3)) is None
