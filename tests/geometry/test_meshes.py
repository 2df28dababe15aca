"""Tests of bodies from mesh files in Bullet."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from workbench import Thing, run, scene

from hybrid_tamp.geometry.shapes import MeshFile
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.physics.pictures.appearance import draw_tokens
from hybrid_tamp.physics.pictures.outlines import bounding_radius
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.physics.scene import make_bodies
from hybrid_tamp.taskfile.meshfile import read_mesh

MESHES = Path(__file__).parents[2] / "problems" / "meshes"


def still(elapsed: float, state: State) -> dict[Any, Any]:
    return {}


def thing(name: str) -> Token:
    shape = read_mesh(MESHES / name, MeshFile(kind="mesh", file=name))
    return Token.make("thing", [Thing], {"mass": 8.0, "friction": 0.6}, shape)


def test_a_concave_box_stands_on_its_edges_as_high_as_its_file_says() -> None:
    task = scene({("thing", "position"): (0.0, 0.0, 0.15)}, thing=thing("p5.obj"))
    rest = run(task, 1.0, still)[-1]
    assert rest["thing", "position"] == pytest.approx([0.0, 0.0, 0.15], abs=2e-4)
    assert rest["thing", "orientation"] == pytest.approx([0.0, 0.0, 0.0, 1.0], abs=1e-3)


def test_a_ball_fits_into_the_hollow() -> None:
    """The middle of the top side is 3 cm below its edges. On a convex hull, the ball would be 3 cm higher."""
    ball = Token.make("ball", [Thing], {"mass": 1.0}, read_ball())
    task = scene(
        {("thing", "position"): (0.0, 0.0, 0.15), ("ball", "position"): (0.0, 0.0, 0.372)},
        thing=thing("p5.obj"),
        ball=ball,
    )
    rest = run(task, 1.0, still)[-1]
    assert rest["ball", "position"] == pytest.approx([0.0, 0.0, 0.37], abs=0.004)


def read_ball() -> Any:
    return read_mesh(MESHES / "sphere.obj", MeshFile(kind="mesh", file="sphere.obj"))


def test_its_inertia_is_that_of_the_prism() -> None:
    (body,) = make_bodies(scene({}, thing=thing("box.obj")))
    expected = [8.0 * (one**2 + other**2) / 12 for one, other in ((0.28, 0.33), (0.3, 0.33), (0.3, 0.28))]
    assert body.inertia == pytest.approx(expected)


def test_every_part_of_a_mesh_is_drawn_and_in_the_picture() -> None:
    task = scene({}, thing=thing("p5.obj"))
    drawn = np.concatenate([part.mesh.vertices for part in draw_tokens(task)])
    assert len(draw_tokens(task)) == 32
    assert drawn.max(axis=0) == pytest.approx([0.15, 0.14, 0.15])
    assert np.linalg.norm(drawn, axis=1).max() <= bounding_radius(task.tokens[0]) + 1e-9


def test_a_snapshot_of_parts_in_contact_is_gone_back_to_bit_for_bit() -> None:
    # The body tilts onto an edge and falls back, so that contacts of its parts begin and end.
    start = {("thing", "position"): (0.0, 0.0, 0.2), ("thing", "angular_velocity"): (0.0, 2.0, 0.5)}
    task = scene(start, thing=thing("p5.obj"))
    with open_backend("pybullet") as backend:
        backend.reset(task, task.state)
        for _ in range(40):
            backend.step({})
        with backend.snapshot() as go_back:
            runs = []
            for _ in range(2):
                go_back()
                runs.append([backend.step({}).values for _ in range(60)])
        backend.reset(task, task.state)
        straight = [backend.step({}).values for _ in range(100)][40:]
    np.testing.assert_array_equal(runs[0], straight)
    np.testing.assert_array_equal(runs[1], straight)
