"""Tests of imitation by another agent. Movements that cannot be imitated and invalid demonstrations are refused."""

import json
import subprocess
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from texts import load_task_text

import hybrid_tamp
from hybrid_tamp.errors import InputError, NoPlan
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.execution.storage import save
from hybrid_tamp.model.imitation import Segmentation
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.questions.imitate.observation import Shown
from hybrid_tamp.questions.imitate.segmentation import segment
from hybrid_tamp.questions.imitate.transfer import transfer
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.pose_tables import read_poses
from hybrid_tamp.verbs.imitate import read_shown

PROBLEMS = Path(__file__).resolve().parents[2] / "problems"
OTHER = (PROBLEMS / "roll_by_another_agent.yaml").read_text(encoding="utf-8")
"""A task of a second agent, whose hand is at another place and rolls another object in the opposite direction."""


@cache
def rolled() -> tuple[Task, TaskPlan, Recording]:
    task = load_task(PROBLEMS / "roll_cylinder.yaml")
    plan = hybrid_tamp.plan(task).required()
    with open_backend("analytic") as physics:
        return task, plan, execute(task, plan, physics)


@pytest.fixture
def run_folder(tmp_path: Path) -> Path:
    folder = tmp_path / "shown"
    folder.mkdir()
    save(rolled()[2], folder / "recording.npz")
    (folder / "task.yaml").write_text((PROBLEMS / "roll_cylinder.yaml").read_text())
    return folder


def poses(every: int = 4, noise: float = 0.0) -> list[str]:
    """Return the lines of a table of observed poses, by default at 60 Hz, with noise [m, or of quaternions]."""
    task, _, recording = rolled()
    names, columns = ["time [s]"], [recording.times[:, None]]
    for token in task.assigned:
        names += [f"{token.name}.{part}" for part in ("x [m]", "y [m]", "z [m]", "qx", "qy", "qz", "qw")]
        columns += [recording.trajectory[token, "position"], recording.trajectory[token, "orientation"]]
    rows = np.concatenate(columns, axis=-1)[::every]
    rows[:, 1:] += noise * np.random.default_rng(0).standard_normal(rows[:, 1:].shape)
    for part in range(4, rows.shape[1], 7):
        rows[:, part : part + 4] /= np.linalg.norm(rows[:, part : part + 4], axis=-1, keepdims=True)
    return [", ".join(names), *(", ".join(f"{value:.6f}" for value in row) for row in rows)]


def segmented(shown: Shown) -> Segmentation:
    return segment(shown.task, shown.observation)


Command = Callable[..., "subprocess.CompletedProcess[str]"]


def test_another_agent_rolls_another_thing_in_pybullet(tmp_path: Path, run_folder: Path, command: Command) -> None:
    (tmp_path / "other.yaml").write_text(OTHER)
    done = command("imitate", run_folder, tmp_path / "other.yaml", "-o", tmp_path / "out", "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["roles"] == {"hand": "paddle", "drum": "barrel", "goal": "yard"}
    assert [each["block"] for each in told["instances"] if each["block"] != "RESTING"] == ["REACHING:behind", "ROLLING"]
    assert told["result"]["success"]
    assert told["result"]["law"] == []
    assert list(told["primitives"]) == ["REACHING:behind"]
    assert 'primitives:\n  "REACHING:behind": primitive-01.json' in (tmp_path / "out" / "task.yaml").read_text()
    replayed = command("replay", tmp_path / "out")
    assert "bit-identical" in replayed.stdout, replayed.stderr


def test_a_table_of_poses_shows_as_much(tmp_path: Path) -> None:
    task, _, recording = rolled()
    (tmp_path / "shown.csv").write_text("\n".join(poses()))
    found = segmented(read_shown(tmp_path / "shown.csv", task))
    assert sorted(i.block for i in found.plan.instances) == sorted(i.block for i in recording.instances)
    assert not found.unexplained
    other = load_task_text(OTHER, "other")
    moved = transfer(task, found.plan, other)
    assert not check_law(other, moved.plan)
    assert moved.roles == {"hand": "paddle", "drum": "barrel", "goal": "yard"}


def test_a_table_of_poses_tells_how_noisy_it_is(tmp_path: Path) -> None:
    task, _, recording = rolled()
    (tmp_path / "shown.csv").write_text("\n".join(poses(2, 0.001)))
    times, states, deviation = read_poses(tmp_path / "shown.csv", task)
    np.testing.assert_allclose(deviation["hand", "position"], 0.001, rtol=0.25)
    assert not deviation["goal", "position"].any()
    still = states["drum", "velocity"][(times > 0.5) & (times < 2.0)]
    assert np.sqrt(np.mean(still**2)) == pytest.approx(deviation["drum", "velocity"][0], rel=0.5)
    found = segmented(read_shown(tmp_path / "shown.csv", task))
    assert sorted(i.block for i in found.plan.instances) == sorted(i.block for i in recording.instances)
    assert not found.unexplained


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("inside: [barrel, yard]", "at_rest: [barrel]", "has the goal inside(drum, goal), but"),
        (
            "  - inside: [barrel, yard]",
            "  - inside: [barrel, yard]\n  - at_rest: [paddle]",
            "has the goal at_rest(paddle), but",
        ),
        ("workspace_lower: [-1.4", "workspace_lower: [0.0", "within_workspace(paddle, barrel, yard) does not hold"),
    ],
)
def test_why_something_cannot_be_imitated(old: str, new: str, words: str) -> None:
    task, plan, _ = rolled()
    assert old in OTHER
    with pytest.raises(NoPlan, match="cannot be imitated") as refused:
        transfer(task, plan, load_task_text(OTHER.replace(old, new), "other"))
    assert words in str(refused.value)


def test_a_missing_class_is_named() -> None:
    task, plan, _ = rolled()
    other = load_task_text(OTHER, "other")
    handless = replace(other, tokens=tuple(t for t in other.tokens if t.name != "paddle"))
    with pytest.raises(NoPlan, match="is a member of STATIC END-EFFECTOR, but no token of other is"):
        transfer(task, plan, handless)


LINES = ["time [s], hand.x, hand.y, hand.z", *(f"0.{n}, {n}.5, 0, 0.3" for n in range(6))]


@pytest.mark.parametrize(
    ("number", "line", "place", "words"),
    [
        (1, "", "1:1", ("must name the columns time, token.x", "got '0.0'")),
        (1, "t, hand.x, hand.y, hand.z", "1:1", ("must name the columns time, token.x",)),
        (1, "time, hand.x, hnd.y, hand.z", "1:15", ("must belong to a token", "did you mean 'hand.y'")),
        (1, "time, hand.x, hand.y, hand.y", "1:23", ("must not occur twice", "hand.y")),
        (1, "time, hand.x, hand.y, drum.z", "1:7", ("hand.x, hand.y, hand.z must occur together", "no hand.z")),
        (1, "time, goal.x, goal.y, goal.z", "1:7", ("must belong to a token",)),
        (3, "0.1, 1.5, 0", "3:11", ("every line must have 4 columns",)),
        (3, "0.1, 1.5, 0, abc", "3:14", ("a number", "abc")),
        (3, "0.1, 1.5, 0, nan", "3:14", ("finite",)),
        (3, "0.0, 1.5, 0, 0.3", "3:1", ("time must increase",)),
        (7, "1e4, 1.5, 0, 0.3", "7:1", ("must not be longer than 600 s",)),
    ],
)
def test_faults_of_a_table_of_poses(tmp_path: Path, number: int, line: str, place: str, words: tuple[str, ...]) -> None:
    file = tmp_path / "shown.csv"
    file.write_text("\n".join(line if n == number else old for n, old in enumerate(LINES, start=1)).lstrip("\n"))
    with pytest.raises(InputError) as refused:
        read_poses(file, rolled()[0])
    assert any(issue.where == f"{file}:{place}" for issue in refused.value.issues), str(refused.value)
    assert all(word in str(refused.value) for word in words), str(refused.value)


def test_bad_input_ends_with_30(tmp_path: Path, command: Command) -> None:
    (tmp_path / "shown.csv").write_text("time, hand.x\n")
    (tmp_path / "other.yaml").write_text(OTHER)
    done = command("imitate", tmp_path / "shown.csv", tmp_path / "other.yaml")
    assert done.returncode == 30
    assert "shown.csv:1:7" in done.stderr
    assert command("imitate", tmp_path / "nothing", tmp_path / "other.yaml").returncode == 30
