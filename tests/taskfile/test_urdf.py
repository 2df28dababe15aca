"""Scenes are read from URDF files, in PyBullet's poses, and every fault names the file and the link or joint."""

from pathlib import Path

import numpy as np
import pybullet
import pytest

import hybrid_tamp
from hybrid_tamp.cli import main
from hybrid_tamp.errors import InputError
from hybrid_tamp.geometry.shapes import Box, Cylinder
from hybrid_tamp.taskfile.urdf import read_urdf

KITCHEN = """<robot name="kitchen">
  <link name="world"/>
  <link name="table">
    <collision><origin xyz="0 0 0.29" rpy="0 0 0.4"/><geometry><box size="0.6 0.4 0.02"/></geometry></collision>
    <collision><origin xyz="0.2 0.1 0.14"/><geometry><cylinder radius="0.02" length="0.28"/></geometry></collision>
  </link>
  <link name="shelf">
    <visual><geometry><sphere radius="3"/></geometry></visual>
    <collision><origin rpy="0 0.2 0"/><geometry><box size="0.3 1.0 0.8"/></geometry></collision>
  </link>
  <joint name="one" type="fixed">
    <parent link="world"/><child link="table"/><origin xyz="-0.2 1.2 0" rpy="0 0 1"/>
  </joint>
  <joint name="two" type="fixed">
    <parent link="table"/><child link="shelf"/><origin xyz="0.9 0 0.6" rpy="0.3 0 0"/>
  </joint>
</robot>"""


def write(folder: Path, text: str = KITCHEN) -> Path:
    file = folder / "kitchen.urdf"
    file.write_text(text, encoding="utf-8")
    return file


def test_geometries_become_bodies(tmp_path: Path) -> None:
    bodies = read_urdf(write(tmp_path))
    assert [body.name for body in bodies] == ["table-1", "table-2", "shelf"]
    assert bodies[0].shape == Box(kind="box", half_extents=(0.3, 0.2, 0.01))
    assert bodies[1].shape == Cylinder(kind="cylinder", radius=0.02, length=0.28)


def test_bodies_are_where_pybullet_loads_them(tmp_path: Path) -> None:
    file = write(tmp_path)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        scene = pybullet.loadURDF(str(file), useFixedBase=True, physicsClientId=client)
        expected = []
        for link in range(pybullet.getNumJoints(scene, physicsClientId=client)):
            frame = pybullet.getLinkState(scene, link, physicsClientId=client)[:2]
            for shape in pybullet.getCollisionShapeData(scene, link, physicsClientId=client):
                expected.append(pybullet.multiplyTransforms(*frame, *shape[5:7]))
    finally:
        pybullet.disconnect(client)
    found = read_urdf(file)
    assert len(found) == len(expected)
    for body, (position, orientation) in zip(found, expected, strict=True):
        assert body.position == pytest.approx(np.array(position), abs=1e-6)
        assert abs(float(body.orientation @ np.array(orientation))) == pytest.approx(1.0, abs=1e-6)


def test_a_scene_is_added_saved_and_planned(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "task.yaml"
    arguments = ["scene", "roll_cylinder", str(write(tmp_path)), "--at", "0", "0.5", "0", "-o", str(target)]
    assert main(arguments) == 0
    assert "3 bodies added (table-1, table-2, shelf)" in capsys.readouterr().out
    task = hybrid_tamp.load_task(target)
    assert task.state["table-1", "position"] == pytest.approx([-0.2, 1.7, 0.29])
    assert main(arguments) != 0  # The file exists.


def test_names_that_are_taken_get_numbers(tmp_path: Path) -> None:
    file = write(tmp_path)
    task = hybrid_tamp.add_scene(hybrid_tamp.add_scene("roll_cylinder", [file]), [file])
    assert [token.name for token in task.tokens][-3:] == ["table-1-2", "table-2-2", "shelf-2"]


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("</robot>", "", "must be well-formed XML"),
        ("robot", "sdf", "must be 'robot'"),
        ('name="two" type="fixed"', 'name="two" type="revolute"', "joint 'two': the joints of a scene must be fixed"),
        ('<child link="shelf"/>', '<child link="chair"/>', "a joint must connect two links; got 'chair'"),
        ('<child link="shelf"/>', '<child link="table"/>', "at most one parent; got 'table'"),
        ('<parent link="world"/>', '<parent link="shelf"/>', "must not be its own ancestor"),
        (
            'size="0.6 0.4 0.02"',
            'size="0.6 0.4"',
            "link 'table': the size of box must be 3 finite numbers; got '0.6 0.4'",
        ),
        ('size="0.6 0.4 0.02"', 'size="0.6 0.4 -1"', "the size of a box must be positive"),
        ('rpy="0 0 0.4"', 'rpy="0 0 nan"', "the rpy of origin must be 3 finite numbers"),
        ('<box size="0.6 0.4 0.02"/>', "<capsule/>", "must be one box, cylinder, sphere or mesh; got capsule"),
        (
            '<box size="0.6 0.4 0.02"/>',
            '<mesh filename="package://a.obj"/>',
            "must be a path relative to the URDF file",
        ),
        ('<box size="0.6 0.4 0.02"/>', '<mesh filename="a.obj" scale="1 2 1"/>', "must be equal along all axes"),
        ('<link name="shelf">', "<link>", "each link must have a name"),
    ],
)
def test_faults_are_named(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert old in KITCHEN
    with pytest.raises(InputError) as caught:
        read_urdf(write(tmp_path, KITCHEN.replace(old, new)))
    assert said in str(caught.value)
    assert "kitchen.urdf" in str(caught.value)


def test_a_scene_without_geometries_and_other_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="must have a link with a collision geometry"):
        read_urdf(write(tmp_path, '<robot name="r"><link name="a"/></robot>'))
    with pytest.raises(InputError, match=r"must end in .urdf or .obj"):
        hybrid_tamp.add_scene("roll_cylinder", [tmp_path / "kitchen.sdf"])
