"""Blocked movements are refused as proven only if a grid proves it. The reason names body, depth and place."""

from pathlib import Path

from ruamel.yaml import YAML

import hybrid_tamp
from hybrid_tamp.taskfile.domains import find_task_file

from .test_detours import write_task

Boxes = list[tuple[list[float], list[float]]]
"""Positions and half extents of walls [m]."""


def across(gap: float) -> Boxes:
    """Return walls across the whole workspace, with a gap of a width [m] between them."""
    return [([0.2 + side * (0.6 + gap / 2), -0.25, 0.65], [0.6, 0.02, 0.65]) for side in (-1, 1)]


def test_a_hand_behind_walls_with_a_narrow_gap_cannot_reach_the_drum(tmp_path: Path) -> None:
    found = hybrid_tamp.plan(write_task(tmp_path, across(0.05)))
    assert found.status == "unsolvable"
    said = str(found.error)
    assert "REACHING:behind with hand=hand, object=drum, region=goal: hand hits wall-0, 0.0539 m deep at (" in said
    assert "no path avoids all bodies" in said
    assert found.error is not None
    assert found.error.exit_status == 10


def test_between_a_proof_and_a_path_is_a_grey_zone(tmp_path: Path) -> None:
    found = hybrid_tamp.plan(write_task(tmp_path, across(0.066)))
    assert found.status == "unknown"
    assert "the search found no path around it" in str(found.error)


def test_a_path_leads_through_a_gap_that_is_a_little_wider_than_the_hand(tmp_path: Path) -> None:
    found = hybrid_tamp.plan(write_task(tmp_path, across(0.1)))
    assert found.plan is not None
    assert [each.name for each in found.plan.instances if each.path] == ["REACHING-1"]


def test_a_place_inside_a_wall_cannot_be_reached(tmp_path: Path) -> None:
    found = hybrid_tamp.plan(write_task(tmp_path, [([-0.25, 0.0, 0.3], [0.1, 0.3, 0.3])]))
    assert found.status == "unsolvable"
    assert "hand hits wall-0, 0.05 m deep at (-0.19, -0.00, 0.14), which no execution of this movement avoids" in str(
        found.error
    )


def test_a_crate_that_some_block_could_move_proves_nothing(tmp_path: Path) -> None:
    data = YAML(typ="safe").load(find_task_file("roll_cylinder").read_text(encoding="utf-8"))
    data["tokens"]["crate"] = {
        "classes": ["TUMBLABLE"],
        "properties": {"half_extents": [0.05, 0.15, 0.1], "mass": 10, "friction": 0.6},
        "pose": {"position": [0.45, 0.0, 0.1]},
    }
    file = tmp_path / "task.yaml"
    with file.open("w", encoding="utf-8") as stream:
        YAML().dump(data, stream)
    assert hybrid_tamp.plan(file).status == "unknown"
