"""Movements that meet in some timing, compared with dense samples."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from hybrid_tamp.collision.bodies import Body, find_nearest
from hybrid_tamp.collision.meetings import meet, meet_together
from hybrid_tamp.collision.sweeps import Track
from hybrid_tamp.geometry.shapes import Box, Cylinder
from hybrid_tamp.motion.poses import quaternion_from_rpy

UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])
HAND = Body("hand", Cylinder(kind="cylinder", radius=0.035, length=0.16))
CRATE = Body("crate", Box(kind="box", half_extents=(0.15, 0.1, 0.05)))


def straight(body: Body, begin: tuple[float, ...], end: tuple[float, ...], turn: float = 0.0) -> Track:
    """Return the track of a body that moves straight and turns about the vertical by an angle [rad]."""
    turned = quaternion_from_rpy(np.array([0.0, 0.0, turn]))
    return Track(body, np.array([begin, end]), np.array([UPRIGHT, turned]))


def sample_least_distance(one: Track, other: Track, count: int = 25) -> float:
    """Return the least distance between two tracks at all pairs of samples [m]."""
    phases = np.linspace(0.0, 1.0, count)
    return min(find_nearest(one.body, one.at(p), other.body, other.at(q)).distance for p in phases for q in phases)


def test_crossing_paths_meet_although_uniform_timing_would_keep_them_apart() -> None:
    one = straight(HAND, (-1.0, 0.0, 0.3), (1.0, 0.0, 0.3))
    other = straight(CRATE, (0.9, -1.0, 0.3), (0.9, 1.0, 0.3))
    same_time = [find_nearest(HAND, one.at(p), CRATE, other.at(p)).distance for p in np.linspace(0.0, 1.0, 50)]
    assert min(same_time) > 0.2
    assert meet(one, other)
    assert not meet_together(one, other)
    assert meet_together(one, straight(CRATE, (0.0, -1.0, 0.3), (0.0, 1.0, 0.3)))


def test_paths_at_different_heights_do_not_meet() -> None:
    one = straight(HAND, (-1.0, 0.0, 0.3), (1.0, 0.0, 0.3))
    assert not meet(one, straight(CRATE, (0.9, -1.0, 0.16), (0.9, 1.0, 0.16)))
    assert meet(one, straight(CRATE, (0.9, -1.0, 0.18), (0.9, 1.0, 0.18)))


def test_bodies_that_touch_may_be_allowed_to_touch() -> None:
    one = straight(CRATE, (0.0, 0.0, 0.05), (1.0, 0.0, 0.05))
    beside = Body("other crate", CRATE.shape)
    other = straight(beside, (0.0, 0.199, 0.05), (1.0, 0.199, 0.05))
    assert meet(one, other)
    assert not meet(one, other, allowed=-0.03)


@settings(max_examples=25, deadline=None)
@given(*[st.floats(-0.8, 0.8)] * 4, st.floats(0.1, 0.5), st.floats(-1.5, 1.5))
def test_meetings_agree_with_samples(a: float, b: float, c: float, d: float, height: float, turn: float) -> None:
    one = straight(HAND, (-0.8, a, 0.3), (0.8, b, 0.3))
    other = straight(CRATE, (c, -0.8, height), (d, 0.8, height), turn)
    least = sample_least_distance(one, other)
    if meet(one, other):
        assert least < 0.08  # Samples are up to 7 cm apart.
    else:
        assert least > 0.0


@settings(max_examples=25, deadline=None)
@given(*[st.floats(-0.8, 0.8)] * 4, st.floats(0.1, 0.5), st.integers(2, 5))
def test_meetings_at_the_same_time_agree_with_samples(
    a: float, b: float, c: float, d: float, height: float, poses: int
) -> None:
    one = straight(HAND, (-0.8, a, 0.3), (0.8, b, 0.3))
    way = np.linspace((c, -0.8, height), (d, 0.8, height), poses)
    other = Track(CRATE, way, np.tile(UPRIGHT, (poses, 1)))
    times = np.linspace(0.0, poses - 1.0, 200)
    least = min(find_nearest(HAND, one.at(min(t, 1.0)), CRATE, other.at(t)).distance for t in times)
    assert meet_together(one, other) == (least < 0.0) or abs(least) < 0.02
