"""Tests of pictures: the camera shows all bodies, meshes are closed, and drawing has no effect on the simulation."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from predicted_runs import predict
from toys import Toys

from hybrid_tamp.execution.execute import execute
from hybrid_tamp.geometry import triangles
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.motion.poses import rotate
from hybrid_tamp.physics.pictures import camera
from hybrid_tamp.physics.pictures.appearance import choose_colours, draw_tokens, legend
from hybrid_tamp.physics.pictures.camera import Camera, Spheres, frame_camera
from hybrid_tamp.physics.pictures.rendering import open_renderer
from hybrid_tamp.physics.pictures.sight import choose_shot, visible_share
from hybrid_tamp.physics.pictures.subject import find_actors
from hybrid_tamp.physics.pictures.view import View, merge_rectangles, overlap
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
    # Only the margin of the picture remains.
    assert smallest <= (camera.SPARE - 1) * shot.distance


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
    for token, colour in choose_colours(task).items():
        # The inside of a region is half as strong as its colour.
        shades = [np.array(colour), (np.array(colour) + 0.95) / 2]
        assert any((np.abs(hues - shade / shade.sum()).max(axis=1) < 0.03).any() for shade in shades), token


def test_bodies_cast_shadows_and_hide_the_floor(toys: Any) -> None:
    task, plan = scene(toys)
    recording = predict(task, plan)
    with open_renderer(task, recording, 320, 176) as renderer:
        picture = renderer.picture(recording.state(0)).astype(int)
        bounds = renderer.bounds(recording.state(0))
    grey = np.ptp(picture, axis=2) < 30
    assert (grey & (picture.max(axis=2) < 200)).mean() > 0.002, "no shadow"
    left, top, right, bottom = bounds["box"]
    # The disc of the spot hides the upper half of the box.
    lower = picture[(top + 3 * bottom) // 4, (left + right) // 2]
    assert lower[0] - lower[2] > 60, "the box is not where its bounds are"


def moved(task: Any, recording: Any, moves: Any) -> Any:
    """Return the first 30 instants of a recording with random positions and orientations of all bodies."""
    states = recording.states[:30].copy()
    slices = recording.layout.slices
    for token in task.tokens:
        if token.shape is not None:
            states[:, slices[token.name, "position"]] = moves.uniform(
                (-1.5, -1.5, 0.2), (1.5, 1.5, 3.2), (len(states), 3)
            )
            turned = moves.normal(size=(len(states), 4))
            states[:, slices[token.name, "orientation"]] = turned / np.linalg.norm(turned, axis=1, keepdims=True)
    return replace(recording, states=states, times=recording.times[:30])


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), aspect=st.floats(0.6, 2.6))
def test_camera_shows_every_vertex_of_every_moving_body_at_every_instant(seed: int, aspect: float) -> None:
    task, plan = scene(Toys())
    run = moved(task, predict(task, plan), np.random.default_rng(seed))
    view = View(choose_shot(task, run, aspect).camera, round(300 * aspect), 300)
    for mesh in draw_tokens(task):
        state = run.trajectory
        placed = rotate(state[mesh.token, "orientation"][:, None], mesh.mesh.vertices)
        pixels = view.project(placed + state[mesh.token, "position"][:, None])
        assert pixels.min() >= 0
        assert np.all(pixels.max(axis=(0, 1)) <= [view.width, view.height])


def test_tokens_that_take_no_part_do_not_make_the_action_small(toys: Any) -> None:
    task, plan = scene(toys)
    near = predict(task, plan)
    slices, states = near.layout.slices, near.states.copy()
    states[:, slices["ball", "position"]] = [40.0, 0.0, 0.1]
    far = replace(near, states=states)
    assert find_actors(task, far) == {"pusher", "spot"}
    distances = [choose_shot(task, run, 1.6).camera.distance for run in (near, far)]
    assert distances[1] <= distances[0]


def test_body_behind_another_body_is_not_visible(toys: Any) -> None:
    task, plan = scene(toys)
    states = predict(task, plan).trajectory
    names = ["ball", "box"]  # Other tokens, e.g. the hand, hide these bodies, too.
    # The box is at x = 0.5 and the ball at x = 0.9.
    before, behind, aside = (
        visible_share(task, states, names, np.array(eye)) for eye in ([-3, 0.3, 0.15], [3, 0.3, 0.15], [0.7, -3, 0.15])
    )
    assert before == pytest.approx(0.5, abs=0.01), "the box hides the ball, and the hand hides a corner of the box"
    assert behind > 0.9, "the ball hides a small part of the box"
    assert aside == 1.0


def test_points_of_the_floor_appear_where_the_floor_is_seen() -> None:
    view = View(Camera(np.array([0.4, -2.0, 1.5]), np.array([0.0, 0.1, 0.2])), 320, 180)
    pixels = np.array([[10.0, 170.0], [160.0, 90.0], [310.0, 120.0]])
    floor = view.meet_floor(pixels)
    assert view.project(np.column_stack([floor, np.zeros(3)])) == pytest.approx(pixels)
    assert np.all(np.isinf(view.meet_floor([[160.0, -2000.0]])))


corner = st.integers(0, 60)


@given(st.lists(st.tuples(corner, corner, corner, corner), max_size=8))
def test_merged_rectangles_cover_all_and_are_disjoint(rectangles: Any) -> None:
    merged = merge_rectangles(rectangles)
    covered = np.zeros((60, 60), dtype=bool)
    for left, top, right, bottom in merged:
        assert not covered[top:bottom, left:right].any()
        covered[top:bottom, left:right] = True
    for left, top, right, bottom in rectangles:
        if left < right and top < bottom:
            assert covered[top:bottom, left:right].all()
    assert not any(overlap(one, other) for one in merged for other in merged if one is not other)


def test_drawing_does_not_disturb_a_simulation(toys: Any) -> None:
    task, plan = scene(toys)
    with open_backend("pybullet") as backend:
        undisturbed = execute(task, plan, backend)
    with open_backend("pybullet") as backend, open_renderer(task, undisturbed, 64, 48) as renderer:
        disturbed = execute(task, plan, backend, observer=lambda event: renderer.picture(undisturbed.state(0)))
    assert disturbed.states.tobytes() == undisturbed.states.tobytes()


def test_many_hands_get_shades_of_their_own(toys: Any) -> None:
    task = toys.world.pusher("one").pusher("two").pusher("three").spot().task()
    assert len(set(choose_colours(task).values())) == 4
    # Tokens of the same classes have one entry.
    assert [text for text, _ in legend(task)] == ["PUSHER", "SPOT"]


def test_place_in_the_goal_has_its_own_colour(toys: Any) -> None:
    world = toys.world.pusher().spot().spot("other")
    goal, other = (choose_colours(world.task(Atom("near", ("pusher", "spot"))))[name] for name in ("spot", "other"))
    assert goal != other
    assert goal[1] > max(goal[0], goal[2]), "green"


def test_wide_scene_keeps_the_number_of_tiles_bounded(toys: Any) -> None:
    task = toys.world.pusher("one").pusher("two", position=(80.0, 0, 0.5)).spot().task()
    plan = TaskPlan((toys.rest("RESTING-1", 0.0, 0.1, "one"), toys.rest("RESTING-2", 0.0, 0.1, "two")), 0.1)
    recording = replace(predict(task, plan))
    with open_renderer(task, recording, 64, 48) as renderer:
        assert renderer.picture(recording.state(0)).std() > 0
