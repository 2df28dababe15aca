"""A plan whose movements hit a body at rest is refused with the names of both bodies, or replaced by another plan."""

from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

import hybrid_tamp
from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.planning import routing
from hybrid_tamp.taskfile.domains import find_task_file


def plan_with_crate(
    folder: Path, name: str, place: list[float], *, optimise: bool = True, **changes: Any
) -> PlanOutcome:
    """Plan a bundled task with a crate at a place."""
    data = YAML(typ="safe").load(find_task_file(name).read_text(encoding="utf-8"))
    shape = {"kind": "box", "half_extents": [0.05, 0.15, 0.1]}
    data["tokens"]["crate"] = {"classes": ["TOKEN"], "shape": shape, "pose": {"position": place}}
    for token, position in changes.items():
        data["tokens"][token]["pose"]["position"] = position
    file = folder / "task.yaml"
    with file.open("w", encoding="utf-8") as stream:
        YAML().dump(data, stream)
    return hybrid_tamp.plan(file, optimise=optimise)


@pytest.mark.parametrize("optimise", [False, True])
def test_a_crate_in_the_path_of_a_drum_is_named(tmp_path: Path, optimise: bool) -> None:
    found = plan_with_crate(tmp_path, "roll_cylinder", [0.45, 0.0, 0.1], optimise=optimise)
    assert found.plan is None
    assert found.status == "unsolvable"  # No block moves the crate, and every straight way to the goal meets it.
    assert "ROLLING with hand=hand, object=drum, region=goal: drum hits crate, 0.147 m deep" in str(found.error)
    assert "this movement is always straight" in str(found.error)


@pytest.mark.parametrize("place", [[0.35, 0.45, 0.1], [1.0, 0.0, 0.1]])
def test_a_crate_beside_the_path_changes_nothing(tmp_path: Path, place: list[float]) -> None:
    found = plan_with_crate(tmp_path, "roll_cylinder", place)
    assert found.status == "solved"
    assert not found.excluded


def test_if_the_path_to_one_region_is_blocked_the_drum_rolls_to_the_other_region(tmp_path: Path) -> None:
    regions = {"near": [0.7, 0.0, 0.0], "far": [-0.6, 0.0, 0.0]}
    found = plan_with_crate(tmp_path, "roll_second_round", [-0.4, 0.0, 0.1], **regions)
    assert found.plan is not None
    (rolling,) = (each for each in found.plan.instances if each.block == "ROLLING")
    assert rolling.targets["region"] == "near"
    assert [each.shortfall.atom.text for each in found.excluded] == ["clear(drum, crate)"]


def test_a_limit_during_the_check_keeps_the_plan(monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(*_: object) -> None:
        raise LimitReached("time is up", limit="time")

    monkeypatch.setattr(routing, "find_sweeps", stop)
    found = hybrid_tamp.plan("roll_cylinder", optimise=True)
    assert (found.status, found.plan is None) == ("limit", False)
