"""The extents of bodies, and the tops and edges of surfaces."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hybrid_tamp.geometry.shapes import Box, BoxPart, Compound, Cylinder, Shape, Sphere
from hybrid_tamp.geometry.surfaces import points_of
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy, rotate
from hybrid_tamp.skills import Container, Surface, depth_over, edge_towards, extent, ground_below, height_above, top_of

TRAY = Compound(
    kind="compound",
    parts=(
        BoxPart(kind="box", half_extents=(0.2, 0.1, 0.01), position=(0.0, 0.0, 0.01)),
        BoxPart(kind="box", half_extents=(0.01, 0.1, 0.05), position=(0.19, 0.0, 0.07)),
    ),
)
SHAPES = (
    Box(kind="box", half_extents=(0.1, 0.2, 0.3)),
    Sphere(kind="sphere", radius=0.2),
    Cylinder(kind="cylinder", radius=0.1, length=0.5),
    TRAY,
)
_ANGLE = st.floats(-3.0, 3.0)


def placed(
    shape: Shape, rpy: tuple[float, ...] = (0.0, 0.0, 0.0), position: tuple[float, ...] = (0.0, 0.0, 0.0)
) -> State:
    token = Token.make("it", [Surface], {"friction": 0.5}, shape)
    values = {("it", "orientation"): quaternion_from_rpy(np.array(rpy)), ("it", "position"): position}
    return State.of((token,), values)


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.kind)
@given(rpy=st.tuples(_ANGLE, _ANGLE, _ANGLE), direction=st.tuples(_ANGLE, _ANGLE, _ANGLE))
def test_an_extent_is_the_largest_projection_of_the_body(
    shape: Shape, rpy: tuple[float, ...], direction: tuple[float, ...]
) -> None:
    along = np.array(direction)
    length = np.linalg.norm(along)
    if length < 0.1:
        return
    token, state = Token.make("it", [Surface], {"friction": 0.5}, shape), placed(shape, rpy)
    points = rotate(state["it", "orientation"], points_of(shape))
    # The points of round bodies approximate the surface from inside.
    measured = float(extent(state, token, along / length))
    assert measured == pytest.approx(float((points @ along).max() / length), abs=0.01)


def test_extents_of_a_batch_are_those_of_its_states() -> None:
    token = Token.make("it", [Surface], {"friction": 0.5}, TRAY)
    states = [placed(TRAY, (0.1 * k, 0.2 * k, 0.3 * k)) for k in range(4)]
    batch = State(states[0].layout, np.stack([state.values for state in states]))
    along = np.array([0.6, 0.0, 0.8])
    assert extent(batch, token, along).tolist() == [float(extent(state, token, along)) for state in states]


def test_the_ground_is_the_top_of_the_solid_below_or_the_floor() -> None:
    tray = Token.make("it", [Container], {"friction": 0.5}, TRAY)
    state = placed(TRAY, (0.0, 0.0, np.pi / 2), (1.0, 0.0, 0.2))
    at = np.array([[1.0, 0.1, 1.0], [1.0, 0.19, 1.0], [1.3, 0.0, 1.0], [1.0, 0.19, 0.25]])
    assert ground_below(state, at, (tray,)).tolist() == pytest.approx([0.22, 0.32, 0.0, 0.22])
    assert float(top_of(state, tray)) == pytest.approx(0.32)


@pytest.mark.parametrize(
    ("place", "normal", "half"),
    [((2.0, 0.1), (1.0, 0.0), 0.1), ((-2.0, 0.1), (-1.0, 0.0), 0.1), ((0.0, 0.9), (0.0, 1.0), 0.2)],
)
def test_the_edge_towards_a_place_is_the_nearest_side(
    place: tuple[float, float], normal: tuple[float, float], half: float
) -> None:
    table = Token.make("it", [Surface], {"friction": 0.5}, SHAPES[0])
    outward, distance = edge_towards(placed(SHAPES[0]), table, np.array([*place, 0.0]))
    assert outward.tolist() == pytest.approx([*normal, 0.0])
    assert float(distance) == half


def test_depth_and_height_over_a_surface_have_the_sign_of_inside() -> None:
    table = Token.make("table", [Surface], {"friction": 0.5}, SHAPES[0])
    ball = Token.make("ball", [Container], {"friction": 0.5}, Sphere(kind="sphere", radius=0.05))
    state = State.of((table, ball), {("ball", "position"): (0.0, 0.15, 0.36)})
    assert float(depth_over(state, ball, table)) == pytest.approx(0.05)
    assert float(height_above(state, ball, table)) == pytest.approx(0.01)
    outside = state.replace({("ball", "position"): np.array([0.0, 0.3, 0.36])})
    assert float(depth_over(outside, ball, table)) == pytest.approx(-0.1)
