"""Tests of mesh files: their content, and messages with figures about unsuitable meshes."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hybrid_tamp.errors import InputError
from hybrid_tamp.geometry.meshes import Hull, MeshShape, obj_text
from hybrid_tamp.geometry.shapes import MeshFile
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.taskfile.copying import portable
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.meshfile import read_mesh

MESHES = Path(__file__).parents[2] / "problems" / "meshes"
CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def cuboid(edges: tuple[float, float, float], at: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Hull:
    triangles = [triangle for a, b, c, d in SIDES for triangle in ((a, b, c), (a, c, d))]
    return Hull(CUBE * edges + at, np.array(triangles))


def written(path: Path, *parts: Hull, change: Callable[[str], str] = str) -> Path:
    path.write_text(change(obj_text(parts)), encoding="ascii")
    return path


def read(path: Path, scale: float = 1.0) -> MeshShape:
    return read_mesh(path, MeshFile(kind="mesh", file=path.name, scale=scale))


def test_a_box_of_two_halves_has_the_moments_of_the_whole(tmp_path: Path) -> None:
    halves = cuboid((0.2, 0.4, 0.3)), cuboid((0.2, 0.4, 0.3), (0.0, 0.0, 0.3))
    shape = read(written(tmp_path / "b.obj", *halves))
    assert shape.volume == pytest.approx(0.2 * 0.4 * 0.6)
    assert shape.corners == pytest.approx(np.array([[-0.1, -0.2, -0.3], [0.1, 0.2, 0.3]]))
    assert shape.moments == pytest.approx([(0.16 + 0.36) / 12, (0.04 + 0.36) / 12, (0.04 + 0.16) / 12])


def test_the_scale_is_the_length_of_the_files_unit(tmp_path: Path) -> None:
    path = written(tmp_path / "b.obj", cuboid((200.0, 400.0, 300.0)))
    assert read(path, 0.001).corners[1] == pytest.approx([0.1, 0.2, 0.15])


def test_corners_with_textures_negative_numbers_and_polygons(tmp_path: Path) -> None:
    vertices = "".join("v {} {} {}\n".format(*v) for v in CUBE)
    faces = "".join("f " + " ".join(f"{i - 8}/1/2" for i in side) + "\n" for side in SIDES)
    (tmp_path / "b.obj").write_text("# quads\n" + vertices + faces, encoding="ascii")
    assert read(tmp_path / "b.obj").volume == pytest.approx(1.0)


def test_triangles_seen_from_inside_are_turned_round(tmp_path: Path) -> None:
    cube = cuboid((1.0, 1.0, 1.0))
    shape = read(written(tmp_path / "b.obj", Hull(cube.vertices, cube.triangles[:, ::-1])))
    assert shape.volume == pytest.approx(1.0)


def test_shapes_of_equal_files_are_equal() -> None:
    one, other = read(MESHES / "p5.obj"), read(MESHES / "p5.obj")
    assert one == other
    assert hash(one) == hash(other)
    assert one != read(MESHES / "box.obj")


L_SHAPE = Hull(
    np.array([(x, y, z) for z in (0.0, 1.0) for x, y in ((0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2))], dtype=float),
    np.array(
        [(0, 3, 1), (1, 3, 2), (0, 4, 3), (0, 5, 4), (6, 7, 9), (7, 8, 9), (6, 9, 10), (6, 10, 11)]
        + [t for i in range(6) for t in ((i, (i + 1) % 6, 6 + i), ((i + 1) % 6, 6 + (i + 1) % 6, 6 + i))]
    ),
)
FLAT = cuboid((1.0, 1.0, 1e-7))
BAR = cuboid((1.0, 0.1, 0.1))
TURNED = Hull(BAR.vertices @ np.array([[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, np.sqrt(2.0)]]), BAR.triangles)


@pytest.mark.parametrize(
    ("parts", "change", "words"),
    [
        ([cuboid((300.0, 300.0, 300.0))], str, ("between 0.001 m and 10 m", "got 300 m", "scale: 0.001")),
        ([cuboid((1.0, 1.0, 1.0))], lambda t: t[: t.index("f ")], ("a mesh must have triangles", "none")),
        ([cuboid((1.0, 1.0, 1.0))], lambda t: t.rsplit("f ", 1)[0], ("watertight", "3 of 18 edges")),
        ([cuboid((1.0, 1.0, 1.0))], lambda t: t.replace("f 1 2 4", "f 1 1 4"), ("1 of 12 triangles without area",)),
        ([cuboid((1.0, 1.0, 1.0))], lambda t: t.replace("f 1 2 4", "f 1 4 2"), ("watertight", "inconsistent")),
        ([FLAT], str, ("a volume of only",)),
        ([TURNED], str, ("products of inertia", "got 0.49;", "rotate the mesh in its file")),
        ([L_SHAPE], str, ("convex", "a dent of 1 m")),
        ([cuboid((1.0, 1.0, 1.0))], lambda t: t.replace("f 1 2 4", "f 1 2 99"), ("b.obj:10", "'f 1 2 99'")),
        ([cuboid((1.0, 1.0, 1.0))], lambda t: t.replace("v 1 1 1", "v 1 1 nan"), ("must be finite",)),
        ([cuboid((1.0, 1.0, 1.0))], lambda t: t.replace("v 1 1 1", "v 1 1"), ("a vertex must be 'v x y z'",)),
    ],
)
def test_meshes_that_are_refused(
    tmp_path: Path, parts: list[Hull], change: Callable[[str], str], words: tuple[str, ...]
) -> None:
    path = written(tmp_path / "b.obj", *parts, change=change)
    with pytest.raises(InputError) as caught:
        read(path)
    for word in ("b.obj", *words):
        assert word in str(caught.value)


def test_two_pieces_in_one_object(tmp_path: Path) -> None:
    pieces = cuboid((1.0, 1.0, 1.0)), cuboid((1.0, 1.0, 1.0), (2.0, 0.0, 0.0))
    path = written(tmp_path / "b.obj", *pieces, change=lambda text: text.replace("o part-2\n", ""))
    with pytest.raises(InputError, match="several pieces"):
        read(path)


def test_too_many_triangles_are_counted_and_not_read(tmp_path: Path) -> None:
    path = tmp_path / "b.obj"
    with path.open("w", encoding="ascii") as file:
        file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\n")
        for _ in range(100):
            file.write("f 1 2 3\n" * 100_000)
    with pytest.raises(InputError, match="at most 200000 triangles; got 10000000"):
        read(path)
    path.unlink()


TASK = """\
domain: rolling_tumbling
tokens:
  P5:
    classes: [TUMBLABLE]
    properties: {half_extents: [0.15, 0.14, 0.15], hollow: [0.024, 0, 0.024], mass: 12, friction: 0.6}
    shape: {kind: mesh, file: p5.obj}
    pose: {position: [0, 0, 0.15]}
goal:
  - posture: [P5, flat bottom]
"""


def test_a_task_finds_its_mesh_beside_it_and_takes_it_along(tmp_path: Path) -> None:
    (tmp_path / "p5.obj").write_text((MESHES / "p5.obj").read_text(encoding="ascii"), encoding="ascii")
    (tmp_path / "t.yaml").write_text(TASK, encoding="utf-8")
    task = load_task(tmp_path / "t.yaml")
    assert isinstance(task.token_by_name["P5"].shape, MeshShape)
    text, files = portable(task)
    assert text == TASK.replace("p5.obj", "mesh-01.obj")
    folder = RunFolder.create(tmp_path / "run")
    for name, content in {"task.yaml": text, **files}.items():
        folder.write_text(name, content)
    again = load_task(tmp_path / "run" / "task.yaml")
    shape = again.token_by_name["P5"].shape
    assert isinstance(shape, MeshShape)
    assert shape.digest == task.token_by_name["P5"].shape.digest
    folder.clear()
    assert list(folder.path.iterdir()) == []


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("file: p5.obj", "file: p6.obj", ("t.yaml:6:31", "p6.obj", "no file of this name")),
        ("file: p5.obj", "file: p5.stl", ("t.yaml:6:31", "p5.stl", "Wavefront")),
        ("[0.15, 0.14, 0.15]", "[0.15, 0.14, 0.2]", ("the mesh, which extends",)),
        ("hollow: [0.024, 0", "hollow: [0.2, 0", ("hollow must be less than half_extents in x, y and z",)),
        ("[0, 0, 0.15]}\n", "[0, 0, 0.1]}\n", ("lowest point at z = -0.05 m",)),
    ],
)
def test_faults_of_a_mesh_are_told_at_its_place(tmp_path: Path, old: str, new: str, words: tuple[str, ...]) -> None:
    (tmp_path / "p5.obj").write_text((MESHES / "p5.obj").read_text(encoding="ascii"), encoding="ascii")
    (tmp_path / "t.yaml").write_text(TASK.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_task(tmp_path / "t.yaml")
    for word in words:
        assert word in str(caught.value)


def test_what_stands_in_the_hollow_of_a_mesh_is_clear_of_it(tmp_path: Path) -> None:
    (tmp_path / "p5.obj").write_text((MESHES / "p5.obj").read_text(encoding="ascii"), encoding="ascii")
    for x, clear in ((0.165, False), (0.185, True)):
        hand = (
            "  hand:\n    classes: [STATIC END-EFFECTOR]\n    properties: {radius: 0.06, length: 0.1, mass: 1, "
            "maximal_force: 9, workspace_lower: [-1, -1, 0], workspace_upper: [1, 1, 1]}\n"
            f"    pose: {{position: [{x}, 0, 0.15], rpy: [1.5707963267948966, 0, 0]}}\n"
        )
        (tmp_path / "t.yaml").write_text(TASK.replace("goal:", hand + "goal:"), encoding="utf-8")
        if clear:
            load_task(tmp_path / "t.yaml")
        else:
            with pytest.raises(InputError, match="must not overlap other tokens"):
                load_task(tmp_path / "t.yaml")


def test_tokens_with_the_same_file_share_one_shape_until_the_file_changes(tmp_path: Path) -> None:
    path = tmp_path / "block.obj"
    path.write_text(obj_text([cuboid((0.1, 0.2, 0.3))]))
    first = read(path)
    assert read(path) is first
    assert read(path, 0.5) is not first
    path.write_text(obj_text([cuboid((0.1, 0.2, 0.4))]))
    assert read(path).corners[1] == pytest.approx([0.05, 0.1, 0.2])


WEDGE = Hull(
    np.array([(x, y, z) for z in (0.0, 1.0) for x, y in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))]),
    np.array([(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)]),
)
EDGES = (0.4, 0.2, 0.2)


def moved(solid: Hull, *offset: float) -> Hull:
    return solid.moved(np.array(offset))


@pytest.mark.parametrize(
    "parts",
    [
        [cuboid(EDGES), cuboid(EDGES, (0.4, 0.0, 0.0))],
        [cuboid(EDGES), cuboid(EDGES, (0.4002, 0.0, 0.0))],
        [cuboid(EDGES), cuboid(EDGES, (0.3999, 0.0, 0.0))],
        [cuboid(EDGES), cuboid(EDGES, (0.4, 0.2, 0.0)), cuboid(EDGES, (0.0, 0.2, 0.0)), cuboid(EDGES, (0.4, 0.0, 0.0))],
        [moved(WEDGE, -1.0, -1.0, 0.0), Hull(np.array([0.0, 0.0, 1.0]) - WEDGE.vertices, WEDGE.triangles)],
    ],
    ids=["a common face", "a gap of rounding", "an overlap of rounding", "four quarters", "wedges with a common edge"],
)
def test_parts_that_touch(tmp_path: Path, parts: list[Hull]) -> None:
    assert read(written(tmp_path / "b.obj", *parts)).parts


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        (
            [cuboid(EDGES), cuboid((0.2, 0.2, 0.2), (0.2, 0.0, 0.0))],
            ("0.008 m^3 of 0.008 m^3", "'part-1' and 'part-2'"),
        ),
        ([cuboid(EDGES), cuboid(EDGES)], ("0.016 m^3 of 0.016 m^3",)),
        ([cuboid(EDGES), cuboid(EDGES, (0.35, 0.0, 0.0))], ("0.002 m^3 of 0.016 m^3", "more than 1%")),
        ([moved(WEDGE, 0.0, 0.0, 0.0), cuboid((1.0, 1.0, 1.0), (0.25, 0.25, 0.0))], ("0.125 m^3 of 0.5 m^3",)),
        ([cuboid((0.4, 0.4, 0.0001)), cuboid((0.4, 0.4, 0.0001))], ("1.6e-05 m^3 of 1.6e-05 m^3",)),
        (
            [cuboid(EDGES), cuboid(EDGES, (0.41, 0.0, 0.0))],
            ("a gap of 0.01 m between 'part-1' and 'part-2'", "0.00081 m"),
        ),
        (
            [
                cuboid(EDGES),
                cuboid(EDGES, (0.4, 0.0, 0.0)),
                cuboid(EDGES, (0.0, 0.3, 0.0)),
                cuboid(EDGES, (0.4, 0.3, 0.0)),
            ],
            ("a gap of 0.1 m between 'part-1' and 'part-3'",),
        ),
        ([cuboid(EDGES), cuboid(EDGES, (0.43, 0.24, 0.0))], ("a gap of 0.05 m",)),
    ],
)
def test_parts_that_overlap_or_lie_apart(tmp_path: Path, parts: list[Hull], words: tuple[str, ...]) -> None:
    path = written(tmp_path / "b.obj", *parts)
    with pytest.raises(InputError) as caught:
        read(path)
    assert all(word in str(caught.value) for word in ("b.obj", *words)), str(caught.value)
