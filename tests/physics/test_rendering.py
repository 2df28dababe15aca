"""Tests of pictures: the camera shows all bodies, meshes are closed, and drawing has no effect on the simulation."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from predicted_runs import predict

from hybrid_tamp.execution.execute import execute
from hybrid_tamp.geometry import triangles
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.physics.pictures import camera
from hybrid_tamp.physics.pictures.appearance import draw_tokens
from hybrid_tamp.physics.pictures.camera import Spheres, frame_camera, spheres_of
from hybrid_tamp.physics.pictures.rendering import open_renderer
from hybrid_tamp.physics.protocol import open_backend

coordinate = st.floats(-3, 3)
sphere = st.tuples(coordinate, coordinate, coordinate, st.floats(0.01, 0.5))


@settings(deadline=None)
@given(spheres=st.lists(sphere, min_size=1, max_size=6), aspect=st.floats(0.5, 3))
def test_every_sphere_is_inside_the_frustum_and_one_touches_nearly(spheres: Any, aspect: float) -> None:
    array = np.array(spheres)
    seen = Spheres(array[:, :3], array[:, 3])
    shot = frame_camera(seen, aspect)
    forward = (shot.target - shot.eye) / shot.distance
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    offset = seen.centres - shot.eye
    gaps = []
    for axis, tangent in ((right, np.tan(camera.FIELD_OF_VIEW / 2) * aspect), (up, np.tan(camera.FIELD_OF_VIEW / 2))):
        half = np.arctan(tangent)
        for sign in (1, -1):
            inward = np.sin(half) * forward - sign * np.cos(half) * axis
            gaps.append(offset @ inward - seen.radii)
    smallest = np.min(gaps)
    assert smallest >= 0
    # Only the margin of the picture remains, which is 0.08 of the distance at half the angle of view.
    assert smallest <= 0.08 * shot.distance


def test_camera_puts_the_motion_from_left_to_right() -> None:
    along_y = Spheres(np.array([[0.0, 0, 0], [0, 2, 0]]), np.array([0.1, 0.1]))
    shot = frame_camera(along_y, 1.6)
    forward = shot.target - shot.eye
    assert abs(forward[0]) > abs(forward[1])
    assert forward[2] < 0


@pytest.mark.parametrize(
    ("mesh", "volume", "tolerance"),
    [
        (triangles.cylinder(0.1, 0.3), np.pi * 0.1**2 * 0.3, 0.01),
        (triangles.box((0.1, 0.2, 0.3)), 8 * 0.1 * 0.2 * 0.3, 1e-9),
        (triangles.sphere(0.2), 4 / 3 * np.pi * 0.2**3, 0.02),
    ],
)
def test_meshes_are_closed_and_face_outward(mesh: Any, volume: float, tolerance: float) -> None:
    corners = mesh.vertices[mesh.triangles]
    # By the divergence theorem, a surface that faces outward encloses a positive volume.
    enclosed = np.sum(corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])) / 6
    assert enclosed == pytest.approx(volume, rel=tolerance)
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.all(np.einsum("ij,ij->i", faces, mesh.normals[mesh.triangles].sum(axis=1)) >= 0)
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(np.ones(len(mesh.normals)))


def test_floor_tiles_cover_the_floor_without_overlap() -> None:
    light, dark = triangles.tiles((-0.6, -0.3), (0.7, 0.9), 0.25)
    both = triangles.joined(light, dark)
    assert both.vertices[:, :2].min(axis=0) == pytest.approx([-0.75, -0.5])
    assert both.vertices[:, :2].max(axis=0) == pytest.approx([0.75, 1.0])
    assert len(both.triangles) == 2 * 6 * 6
    assert abs(len(light.triangles) - len(dark.triangles)) <= 2


def scene(toys: Any) -> tuple[Any, Any]:
    lying = (np.sqrt(0.5), 0, 0, np.sqrt(0.5))
    world = toys.world.pusher().spot(radius=0.1)
    world = world.thing("drum", toys.cylinder(0.1, 0.3), {"mass": 5.0}, position=(0, 0.3, 0.1), orientation=lying)
    world = world.thing("box", toys.box(0.1, 0.1, 0.2), {"mass": 5.0}, position=(0.5, 0.3, 0.2))
    world = world.thing("ball", toys.sphere(0.1), {"mass": 5.0}, position=(0.9, 0.3, 0.1))
    task = world.task(Atom("near", ("pusher", "spot")))
    plan = toys.one_move()
    resting = [toys.rest(f"RESTING-{i}", 0.0, 1.2, name) for i, name in enumerate(("drum", "box", "ball"), start=3)]
    return task, TaskPlan((*plan.instances, *resting), 1.2)


def test_picture_shows_every_token_in_its_colour(toys: Any) -> None:
    task, plan = scene(toys)
    recording = predict(task, plan)
    with open_renderer(task, recording, 320, 176) as renderer:
        picture = renderer.picture(recording.state(0))
        again = renderer.picture(recording.state(0))
        moved = renderer.picture(recording.state(-1))
    assert picture.shape == (176, 320, 3)
    assert picture.dtype == np.uint8
    assert np.array_equal(picture, again)
    assert not np.array_equal(picture, moved)
    # The corner is background or floor: light.
    assert picture[0, 0].min() > 200
    seen = picture.reshape(-1, 3) / 255.0
    hues = seen / np.maximum(seen.sum(axis=1, keepdims=True), 1e-9)
    for part in draw_tokens(task):
        hue = np.array(part.colour) / sum(part.colour)
        assert (np.abs(hues - hue).max(axis=1) < 0.03).any(), part.token


def test_camera_holds_still_and_sees_the_whole_run(toys: Any) -> None:
    task, plan = scene(toys)
    recording = predict(task, plan)
    seen = spheres_of(task, recording)
    lower, upper = seen.bounds
    for token in task.tokens:
        places = recording.trajectory[token, "position"]
        assert np.all(places >= lower)
        assert np.all(places <= upper)


def test_drawing_does_not_disturb_a_simulation(toys: Any) -> None:
    task, plan = scene(toys)
    with open_backend("pybullet") as backend:
        undisturbed = execute(task, plan, backend)
    with open_backend("pybullet") as backend, open_renderer(task, undisturbed, 64, 48) as renderer:
        disturbed = execute(task, plan, backend, observer=lambda event: renderer.picture(undisturbed.state(0)))
    assert disturbed.states.tobytes() == undisturbed.states.tobytes()


def test_many_hands_get_shades_of_their_own(toys: Any) -> None:
    task = toys.world.pusher("one").pusher("two").pusher("three").spot().task()
    colours = {part.token: part.colour for part in draw_tokens(task)}
    assert len(set(colours.values())) == 4


def test_wide_scene_keeps_the_number_of_tiles_bounded(toys: Any) -> None:
    task = toys.world.pusher("one").pusher("two", position=(80.0, 0, 0.5)).spot().task()
    plan = TaskPlan((toys.rest("RESTING-1", 0.0, 0.1, "one"), toys.rest("RESTING-2", 0.0, 0.1, "two")), 0.1)
    recording = replace(predict(task, plan))
    with open_renderer(task, recording, 64, 48) as renderer:
        assert renderer.picture(recording.state(0)).std() > 0
