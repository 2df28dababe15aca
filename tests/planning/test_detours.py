"""Movements that would hit a wall follow a path around the wall, in the forward models and in physics."""

import json
from pathlib import Path

import pytest
from ruamel.yaml import YAML

import hybrid_tamp
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.taskfile.domains import find_task_file

BETWEEN = ([0.1, -0.25, 0.5], [0.35, 0.03, 0.5])
"""Middle and half extents of a wall between the hand and the drum of `roll_cylinder` [m]."""


def write_task(folder: Path, walls: list[tuple[list[float], list[float]]]) -> Path:
    """Write the bundled task `roll_cylinder` with walls, and with the hand in front of the drum."""
    data = YAML(typ="safe").load(find_task_file("roll_cylinder").read_text(encoding="utf-8"))
    data["tokens"]["hand"]["pose"]["position"] = [0.25, -0.45, 0.3]
    for number, (place, halves) in enumerate(walls):
        data["tokens"][f"wall-{number}"] = {
            "classes": ["TOKEN"],
            "fixed": True,
            "shape": {"kind": "box", "half_extents": halves},
            "pose": {"position": place},
        }
    file = folder / "task.yaml"
    with file.open("w", encoding="utf-8") as stream:
        YAML().dump(data, stream)
    return file


@pytest.fixture(scope="module")
def around(tmp_path_factory: pytest.TempPathFactory) -> tuple[PlanOutcome, Path]:
    """Return a plan around a wall, and the folder with its files."""
    folder = tmp_path_factory.mktemp("around")
    file = write_task(folder, [BETWEEN])
    return hybrid_tamp.plan(file, optimise=True, folder=folder / "out"), folder / "out"


def test_a_hand_moves_around_a_wall_and_does_not_touch_it(around: tuple[PlanOutcome, Path]) -> None:
    outcome, folder = around
    assert outcome.plan is not None
    assert not outcome.excluded
    (reaching,) = (each for each in outcome.plan.instances if each.path)
    assert len(reaching.path) >= 3
    blocks = [each for step in json.loads((folder / "plan.json").read_text())["steps"] for each in step["blocks"]]
    assert [each["path"] for each in blocks if each["path"]] == [[list(corner) for corner in reaching.path]]
    with open_backend("pybullet") as physics:
        recording = execute(outcome.task, outcome.plan, physics)
    assert recording.failure is None
    assert not [contact for contact in recording.contacts if "wall-0" in contact.tokens]


def test_the_path_has_the_same_bits_without_optimisation(around: tuple[PlanOutcome, Path], tmp_path: Path) -> None:
    outcome, _ = around
    again = hybrid_tamp.plan(write_task(tmp_path, [BETWEEN]))
    assert outcome.plan is not None
    assert again.plan is not None
    assert [each.path for each in again.plan.instances] == [each.path for each in outcome.plan.instances]
    assert again.makespan == pytest.approx(outcome.makespan)  # The times follow from the path, too.


def test_a_hand_in_a_closed_room_is_refused_with_the_wall(tmp_path: Path) -> None:
    sides = [
        ([0.25 + x, -0.45 + y, 0.6], [0.02 + abs(y), 0.02 + abs(x), 0.6])
        for x, y in ((-0.2, 0.0), (0.2, 0.0), (0.0, -0.2), (0.0, 0.2))
    ]
    roof = ([0.25, -0.45, 1.25], [0.3, 0.3, 0.05])
    outcome = hybrid_tamp.plan(write_task(tmp_path, [*sides, roof]))
    assert outcome.plan is None
    assert outcome.status == "unsolvable"
    assert "hand hits wall-" in str(outcome.error)
    assert "no path avoids all bodies that stay where they are" in str(outcome.error)


def test_a_place_inside_a_wall_is_named(tmp_path: Path) -> None:
    outcome = hybrid_tamp.plan(write_task(tmp_path, [([-0.2, 0.0, 0.3], [0.07, 0.4, 0.3])]))
    assert outcome.plan is None
    assert "hand hits wall-0" in str(outcome.error)
    assert "which no execution of this movement avoids" in str(outcome.error)
