"""`scripts/judge` reports every kind of broken promise. The tests change recordings so that promises are broken."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from contracts.scripts import load_script
from predicted_runs import predict

import hybrid_tamp
from hybrid_tamp.execution.storage import save
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_axis_angle, quaternion_multiply
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.saving import save_task

JUDGE = load_script("judge")
Change = Callable[[Any, FloatArray, dict[str, Any]], None]
"""Function ``change(run, states, document)`` that changes a recording in place so that it breaks a promise."""
UP, ALONG = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])


def record(name: str, folder: Path) -> Path:
    """Run a bundled task in the forward models of the blocks, and save the recording and the task file."""
    task = load_task(name)
    save(predict(task, hybrid_tamp.plan(task).required()), folder / "recording.npz")
    save_task(task, folder / "task.yaml")
    return folder


@pytest.fixture(scope="module")
def tumbled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record("tumble_two_hands", tmp_path_factory.mktemp("tumbled"))


@pytest.fixture(scope="module")
def lifted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record("lift_two_hands", tmp_path_factory.mktemp("lifted"))


def faults_after(change: Change, folder: Path, broken: Path) -> list[str]:
    """Return the faults that the judge reports after a change of the recording."""
    run = JUDGE.Run(folder)
    with np.load(folder / "recording.npz", allow_pickle=False) as file:
        arrays = dict(file)
    change(run, arrays["states"], run.document)
    arrays["document"] = np.frombuffer(json.dumps(run.document).encode(), dtype=np.uint8)
    np.savez(broken / "recording.npz", **arrays)  # type: ignore[arg-type]
    shutil.copy(folder / "task.yaml", broken / "task.yaml")
    found: list[str] = JUDGE.find_faults(broken)
    return found


def nothing(run: Any, states: FloatArray, document: dict[str, Any]) -> None:
    """Leave the recording as it is."""


def touch(one: str, other: str, block: str, force: float) -> Change:
    """Return a change that adds a contact while an instance of a block runs."""

    def change(run: Any, states: FloatArray, document: dict[str, Any]) -> None:
        name = next(each["name"] for each in document["instances"] if each["block"].startswith(block))
        document["contacts"].append(
            {"tokens": [one, other], "instances": [name, name], "force": force, "time": 1.0, "allowed": False}
        )

    return change


def lead_out(hand: str, distance: float) -> Change:
    """Return a change that puts a hand outside its workspace for one step."""

    def change(run: Any, states: FloatArray, document: dict[str, Any]) -> None:
        upper = run.task["tokens"][hand]["properties"]["workspace_upper"]
        states[len(states) // 2, run.columns[hand, "position"]][0] = upper[0] + distance

    return change


def after(block: str, key: str, alter: Callable[[FloatArray], FloatArray], before_end: int = 0) -> Change:
    """Return a change of the box's pose after the end of a block's last instance."""

    def change(run: Any, states: FloatArray, document: dict[str, Any]) -> None:
        last = [each for each in document["instances"] if each["block"].startswith(block)][-1]
        first = run.rows(last)[1] - before_end
        rows = states[first:, run.columns["box", key]]
        rows[:] = alter(rows)

    return change


def turn(axis: FloatArray, degrees: float) -> Callable[[FloatArray], FloatArray]:
    """Return a function that turns orientations about an axis of the world."""
    return lambda rows: quaternion_multiply(quaternion_from_axis_angle(axis, np.radians(degrees)), rows)


@pytest.mark.parametrize("folder", ["tumbled", "lifted"])
def test_a_good_recording_keeps_its_promises(folder: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    assert faults_after(nothing, request.getfixturevalue(folder), tmp_path) == []


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (touch("hand-1", "hand-2", "TIPPING", 25.0), "hand-1 and hand-2 touched with 25.0 N"),
        (touch("hand-1", "(floor)", "REACHING", 25.0), "hand-1 and the floor touched with 25.0 N"),
        (lead_out("hand-2", 0.006), "hand-2 was 0.0060 m outside its workspace"),
        (after("TIPPING:lower", "orientation", turn(ALONG, 6.0)), "tilt"),
        (after("TIPPING:lower", "orientation", turn(UP, 16.0)), "yaw"),
        (after("TIPPING:lower", "position", lambda rows: rows + np.array([0.06, 0.0, 0.0])), "slip"),
        (after("TIPPING:lower", "angular_velocity", lambda rows: rows + 2.1 * ALONG, 240), "speed"),
    ],
    ids=["hands", "floor", "workspace", "tilt", "yaw", "slip", "speed"],
)
def test_a_broken_tumble_is_reported(change: Change, fault: str, tumbled: Path, tmp_path: Path) -> None:
    found = faults_after(change, tumbled, tmp_path)
    assert any(fault in each for each in found), found


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (after("HOLDING", "orientation", turn(ALONG, 4.0), 10), "box tilted by"),
        (after("HOLDING", "position", lambda rows: rows - 0.1 * UP), "was held only"),
    ],
    ids=["tilt", "height"],
)
def test_a_broken_lift_is_reported(change: Change, fault: str, lifted: Path, tmp_path: Path) -> None:
    found = faults_after(change, lifted, tmp_path)
    assert any(fault in each for each in found), found


@pytest.mark.parametrize(
    "change",
    [
        touch("hand-1", "hand-2", "TIPPING", 19.0),
        touch("hand-1", "box", "TIPPING", 250.0),
        lead_out("hand-2", 0.004),
        after("TIPPING:lower", "orientation", turn(UP, 10.0)),
    ],
    ids=["a light touch", "an allowed contact", "almost inside", "a small yaw"],
)
def test_what_is_within_the_bounds_is_not_reported(change: Change, tumbled: Path, tmp_path: Path) -> None:
    assert faults_after(change, tumbled, tmp_path) == []


def test_a_failed_run_promises_nothing(tumbled: Path, tmp_path: Path) -> None:
    def fail(run: Any, states: FloatArray, document: dict[str, Any]) -> None:
        lead_out("hand-2", 0.1)(run, states, document)
        document["failure"] = {"instance": "box"}

    assert faults_after(fail, tumbled, tmp_path) == []
