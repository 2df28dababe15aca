"""Properties that disagree with the shape of their token: both figures are stated."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from hybrid_tamp_domains.joint_lifting.classes import Liftable
from hybrid_tamp_domains.rolling_tumbling.classes import Rollable, Tumblable
from hybrid_tamp_domains.tool_use.classes import DexterousHand, Pushable, Pusher, Strikable, Striker
from hypothesis import given, settings
from hypothesis import strategies as st
from random_tasks.hammer import HAMMER, HAND, hammer_shape
from texts import load_task_text

from hybrid_tamp.errors import InputError
from hybrid_tamp.geometry.agreement import Disagreement, HalfExtents, ShapeFeature
from hybrid_tamp.geometry.meshes import MeshShape
from hybrid_tamp.geometry.shapes import (
    Box,
    BoxPart,
    Compound,
    Cylinder,
    CylinderPart,
    MeshFile,
    Shape,
    Sphere,
    SpherePart,
)
from hybrid_tamp.model.affordance import AffordanceClass, ObjectClass, Vector3, quantity
from hybrid_tamp.model.agreement import find_disagreements, find_shape_fault
from hybrid_tamp.model.token import Token
from hybrid_tamp.physics.scene import compute_inertia
from hybrid_tamp.skills import Graspable
from hybrid_tamp.taskfile.meshfile import read_mesh

ROOT = Path(__file__).parents[2]
Z = (0.0, 0.0, 1.0)


def mesh(name: str) -> MeshShape:
    return read_mesh(ROOT / "problems" / "meshes" / name, MeshFile(kind="mesh", file=name))


def cylinder(radius: float = 0.1, length: float = 0.3) -> Cylinder:
    return Cylinder(kind="cylinder", radius=radius, length=length)


def wheels() -> Compound:
    """Return two wheels on an axle along y."""
    turned = (math.pi / 2, 0.0, 0.0)
    wheel: dict[str, Any] = {"kind": "cylinder", "radius": 0.1, "length": 0.04, "rpy": turned}
    axle = CylinderPart(kind="cylinder", radius=0.02, length=0.3, position=(0, 0, 0), rpy=turned)
    return Compound(kind="compound", parts=(axle, *(CylinderPart(**wheel, position=(0, y, 0)) for y in (-0.15, 0.15))))


def faults(
    members: type[ObjectClass] | list[type[ObjectClass]], properties: Mapping[str, Any], shape: Shape | None
) -> dict[str, str]:
    """Return a mapping from each property that disagrees with the shape to the requirement and the given value."""
    members = members if isinstance(members, list) else [members]
    token = Token.make("thing", members, properties, shape)
    return {name: f"{each.wanted}; got {each.came}" for name, each in find_disagreements(token)}


def rolling(axis: Any, radius: float, shape: Shape) -> dict[str, str]:
    return faults(
        Rollable, {"axis_of_rotation": axis, "radius_of_rotation": radius, "mass": 5.0, "friction": 0.6}, shape
    )


@pytest.mark.parametrize(
    ("axis", "radius", "shape"),
    [
        (Z, 0.1, cylinder()),
        ((0.0, 0.0, -3.0), 0.1005, cylinder()),
        ((0.01, 0.0, 1.0), 0.1, cylinder()),
        ((1.0, 1.0, 0.0), 0.1, Sphere(kind="sphere", radius=0.1)),
        ((0.0, 1.0, 0.0), 0.1, wheels()),
        ((0.0, -1.0, 0.0), 0.1, wheels()),
    ],
)
def test_shapes_that_roll_as_the_properties_say(axis: Any, radius: float, shape: Shape) -> None:
    assert rolling(axis, radius, shape) == {}


@pytest.mark.parametrize(
    ("axis", "radius", "shape", "words"),
    [
        ((0.0, 1.0, 0.0), 0.1, cylinder(), ("axis_of_rotation", "[0, 0, 1], within 1 degree", "90 degrees off")),
        ((0.0, 0.05, 1.0), 0.1, cylinder(), ("axis_of_rotation", "2.86 degrees off")),
        (Z, 0.12, cylinder(), ("radius_of_rotation", "0.1 m within 1%", "got 0.12 m")),
        (Z, 0.102, Sphere(kind="sphere", radius=0.1), ("radius_of_rotation", "0.1 m within 1%", "got 0.102 m")),
        (Z, 0.1, wheels(), ("axis_of_rotation", "[0, 1, 0]", "ratio of 0.507", "is 1 there")),
        ((0.0, 1.0, 0.0), 0.02, wheels(), ("radius_of_rotation", "0.1 m within 3%", "2 pi", "got 0.02 m")),
    ],
)
def test_a_wrong_axis_or_radius(axis: Any, radius: float, shape: Shape, words: tuple[str, ...]) -> None:
    ((name, said),) = rolling(axis, radius, shape).items()
    assert name == words[0]
    assert all(word in said for word in words[1:]), said


@pytest.mark.parametrize("name", ["cylinder.obj", "prism24.obj", "prism8.obj", "sphere.obj"])
def test_meshes_that_roll(name: str) -> None:
    shape = mesh(name)
    edges = shape.corners[1] - shape.corners[0]
    # The file lies along its longest or only axis of symmetry.
    axis = next(axis for axis in np.eye(3) if not rolling(tuple(axis), 0.001, shape).get("axis_of_rotation"))
    said = rolling(tuple(axis), 0.001, shape)["radius_of_rotation"]
    radius = float(said.split("must be ")[1].split(" m")[0])
    assert radius == pytest.approx(float(np.delete(edges, int(np.argmax(axis))).max()) / 2, rel=0.06)
    assert rolling(tuple(axis), radius, shape) == {}
    assert "radius_of_rotation" in rolling(tuple(axis), 1.05 * radius, shape)
    assert "radius_of_rotation" in rolling(tuple(axis), 0.95 * radius, shape)
    if name != "sphere.obj":
        across = tuple(np.roll(axis, 1))
        assert list(rolling(across, radius, shape)) == ["axis_of_rotation"]


def test_what_is_round_about_no_axis_cannot_roll() -> None:
    for axis in np.eye(3):
        said = rolling(tuple(axis), 0.14, mesh("box.obj"))["axis_of_rotation"]
        assert "must be at least 0.75" in said


@pytest.mark.parametrize("member", [Liftable, Tumblable, Pushable, Strikable])
def test_half_extents_of_boxes(member: type[ObjectClass]) -> None:
    own: dict[str, Any] = {"mass": 2.0, "friction": 0.5, "impulse_needed": 0.5}
    own = {key: value for key, value in own.items() if key in member.model_fields}
    for halves, wrong in (((0.1, 0.2, 0.3), False), ((0.1, 0.2, 0.31), True), ((0.102, 0.2, 0.3), True)):
        found = faults(member, {**own, "half_extents": halves}, Box(kind="box", half_extents=(0.1, 0.2, 0.3)))
        assert list(found) == (["half_extents"] if wrong else [])
        if wrong:
            assert "to [0.1, 0.2, 0.3] m, within 1%; got [" in found["half_extents"]


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        (cylinder(0.04, 0.08), {"radius": "must be 0.04 m within 1%, the radius of the shape; got 0.03 m"}),
        (cylinder(0.03, 0.1), {"length": "must be 0.1 m within 1%, the length of the shape; got 0.08 m"}),
        (Sphere(kind="sphere", radius=0.03), dict.fromkeys(("radius", "length"), "got a sphere as shape")),
        (None, {}),
    ],
)
def test_the_size_of_a_hand(shape: Shape | None, words: dict[str, str]) -> None:
    found = faults(DexterousHand, HAND, shape)
    assert set(found) == set(words)
    assert all(words[name] in said for name, said in found.items())


def tool(**changes: Any) -> dict[str, str]:
    return faults([Striker, Pusher], {**HAMMER, **changes}, hammer_shape())


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, {}),
        ({"inertia": (1.0, 1e-6, 1e-6)}, {"inertia": "the sum of the other two, 2e-06 kg m^2; got [1, 1e-06, 1e-06]"}),
        ({"inertia": (0.0003, 0.00199, 0.003)}, {"inertia": "none exceeds the sum of the other two, 0.00229 kg m^2"}),
        ({"inertia": (0.0003, 0.02, 0.02)}, {"inertia": "0.6 kg within the shape, which in this ratio are at most ["}),
        ({"mass": 0.1}, {"inertia": "0.1 kg within the shape"}),
        ({"handle_from": (-0.3, 0.0, 0.0)}, {"handle_from": "got [-0.3, 0, 0] m, 0.125 m away"}),
        ({"impact_point": (0.025, 0.0, -0.06)}, {"impact_point": "within 0.0043 m of the shape; got"}),
        ({"impact_point": (0.025, 0.0, -0.01)}, {"impact_point": "on the surface of the shape, within 0.0043 m; got"}),
        ({"pushing_point": (0.025, 0.0, 0.08)}, {"pushing_point": "0.035 m away"}),
    ],
)
def test_a_hammer(changes: dict[str, Any], words: dict[str, str]) -> None:
    found = tool(**changes)
    assert set(found) == set(words)
    assert all(words[name] in said for name, said in found.items()), found


class Spun(AffordanceClass):
    """Has moments of inertia of its own."""

    name: ClassVar[str] = "SPUN"
    mass: float = quantity("kg", "mass", gt=0)
    inertia: Vector3 = quantity("kg m^2", "principal moments")


@given(st.integers(0, 3), st.tuples(*[st.floats(0.02, 0.5)] * 3), st.floats(0.1, 50.0), st.floats(0.01, 1.0))
@settings(max_examples=40, deadline=None)
def test_moments_of_bodies_are_accepted_and_larger_ones_refused(
    kind: int, size: tuple[float, float, float], mass: float, hollow: float
) -> None:
    a, b, c = size
    shape: Shape = (
        Box(kind="box", half_extents=size),
        Cylinder(kind="cylinder", radius=a, length=2 * b),
        Sphere(kind="sphere", radius=a),
        Compound(kind="compound", parts=(BoxPart(kind="box", half_extents=size, position=(0, 0, 0)),)),
    )[kind]
    solid = np.array(compute_inertia(shape, mass))
    # The whole mass at the corners of the box or on the rims of the cylinder gives the largest moments.
    largest = {
        0: mass * np.array([b * b + c * c, a * a + c * c, a * a + b * b]),
        1: mass * np.array([a * a / 2 + b * b, a * a / 2 + b * b, a * a]),
        2: mass * np.array([2 * a * a / 3] * 3),
    }[kind % 3]
    for moments in (solid, hollow * solid, largest):
        assert faults(Spun, {"mass": mass, "inertia": tuple(moments)}, shape) == {}
    for moments in (1.05 * largest, [largest.max() * 2, *largest[1:] / 9]):
        found = faults(Spun, {"mass": mass, "inertia": tuple(map(float, moments))}, shape)
        assert "kg m^2; got [" in found["inertia"] or "kg m^2, within 1%; got [" in found["inertia"]


@given(st.floats(0.005, 2.0), st.floats(0.005, 2.0), st.floats(-1.0, 1.0), st.booleans())
@settings(max_examples=40, deadline=None)
def test_rolling_properties_within_and_beyond_the_tolerances(
    radius: float, length: float, part: float, ball: bool
) -> None:
    shape: Shape = Sphere(kind="sphere", radius=radius) if ball else cylinder(radius, length)
    axis = (math.sin(0.9 * part * math.radians(1)), 0.0, math.cos(0.9 * part * math.radians(1)))
    assert rolling(axis, radius * (1 + 0.0099 * part), shape) == {}
    assert set(rolling(axis, radius * (1.011 + abs(part)), shape)) == {"radius_of_rotation"}
    tilt = math.radians(1.1 + 88 * abs(part))
    tilted = rolling((math.sin(tilt), 0.0, math.cos(tilt)), radius, shape)
    assert set(tilted) == (set() if ball else {"axis_of_rotation"})


def test_a_feature_of_a_new_class_is_one_declaration() -> None:
    class Doubled(ShapeFeature):
        def find_fault(self, value: Any, shape: Shape, properties: Mapping[str, Any]) -> Disagreement | None:
            return Disagreement("must be two", str(value)) if value != 2 else None

    class New(AffordanceClass):
        name: ClassVar[str] = "NEW"
        of_shape: ClassVar[Mapping[str, ShapeFeature]] = {"size": HalfExtents(), "factor": Doubled()}
        size: Vector3 = quantity("m", "half of the edges")
        factor: float = quantity("1", "a number")

    box = Box(kind="box", half_extents=(0.1, 0.1, 0.1))
    assert faults(New, {"size": (0.1, 0.1, 0.1), "factor": 2.0}, box) == {}
    found = faults(New, {"size": (0.1, 0.1, 0.2), "factor": 3.0}, box)
    assert found["factor"] == "must be two; got 3.0"
    assert "[0.1, 0.1, 0.2] m" in found["size"]


def bars(*parts: Any) -> Token:
    return Token.make("thing", [], {}, Compound(kind="compound", parts=parts))


def cube(*position: float, half: float = 0.1) -> BoxPart:
    return BoxPart(kind="box", half_extents=(half, half, half), position=position)


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ((cube(-0.1, 0, 0), cube(0.1, 0, 0)), ()),
        ((cube(-0.1001, 0, 0), cube(0.1001, 0, 0)), ()),
        ((cube(-0.15, 0, 0), cube(0.15, 0, 0)), ("a gap of 0.1 m between parts[0] and parts[1]", "at most 0.0005 m")),
        ((cube(-0.05, 0, 0), cube(0.05, 0, 0)), ("0.004 m^3 of 0.008 m^3 shared by parts[0] and parts[1]", "1%")),
        ((cube(0.3, 0, 0), cube(0.5, 0, 0)), ("a hull that is 0.2 m away from the origin",)),
        ((cube(0.0, 0, 0), cube(0.2, 0, 0)), ("a centre of mass at [0.1, 0, 0] m", "unless the property inertia")),
        (
            (SpherePart(kind="sphere", radius=0.1, position=(-0.2, 0, 0)), cube(0.1, 0.2, 0), cube(0.1, -0.2, 0)),
            ("a gap of", "must have parts that touch"),
        ),
    ],
)
def test_parts_of_a_compound(parts: Any, words: tuple[str, ...]) -> None:
    fault = find_shape_fault(bars(*parts))
    said = "" if fault is None else f"{fault.wanted}; got {fault.came}"
    assert bool(said) == bool(words)
    assert all(word in said for word in words), said


def test_parts_may_overlap_if_the_moments_of_inertia_are_given() -> None:
    assert (
        find_shape_fault(
            Token.make("hammer", [Graspable], {k: v for k, v in HAMMER.items() if "point" not in k}, hammer_shape())
        )
        is None
    )
    assert find_shape_fault(bars(*hammer_shape().parts)) is not None


@pytest.mark.parametrize(
    ("name", "old", "new", "words"),
    [
        ("roll_cylinder", "axis_of_rotation: [0, 0, 1]", "axis_of_rotation: [1, 0, 0]", ("axis_of_rotation of token",)),
        ("roll_cylinder", "radius_of_rotation: 0.10", "radius_of_rotation: 0.2", ("radius_of_rotation of token",)),
        ("hammer_push", "inertia: [0.0003", "inertia: [0.1", ("inertia of token 'hammer'", "the sum of the other two")),
        ("hammer_push", "position: [-0.075, 0, 0]", "position: [-0.3, 0, 0]", ("shape of token 'hammer'", "a gap of")),
    ],
)
def test_files_that_are_refused(name: str, old: str, new: str, words: tuple[str, ...]) -> None:
    text = (ROOT / "problems" / f"{name}.yaml").read_text(encoding="utf-8")
    assert old in text
    load_task_text(text, name)
    with pytest.raises(InputError) as caught:
        load_task_text(text.replace(old, new), name)
    assert all(word in str(caught.value) for word in words), str(caught.value)


@pytest.mark.parametrize(
    ("shape", "hollow", "said"),
    [
        (Box(kind="box", half_extents=(0.1, 0.2, 0.3)), (0.0, 0.0, 0.0), ""),
        (Box(kind="box", half_extents=(0.1, 0.2, 0.3)), (0.0, 0.0, 0.02), "the shape, [0, 0, 0] m, within 3%"),
        (mesh("p5.obj"), (0.024, 0.0, 0.024), ""),
        (mesh("p5.obj"), (0.05, 0.0, 0.024), "got [0.05, 0, 0.024] m"),
        (mesh("p5.obj"), (0.024, 0.02, 0.024), "must be at most the depths of the hollows"),
    ],
)
def test_the_depth_of_hollows(shape: Shape, hollow: Vector3, said: str) -> None:
    halves = (0.1, 0.2, 0.3) if isinstance(shape, Box) else tuple(map(float, shape.corners[1]))
    found = faults(Tumblable, {"half_extents": halves, "hollow": hollow, "mass": 5.0, "friction": 0.5}, shape)
    assert set(found) == ({"hollow"} if said else set())
    assert said in found.get("hollow", "")
