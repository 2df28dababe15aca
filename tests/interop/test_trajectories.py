"""Trajectories of recordings are tables that pandas and the verb `imitate` read."""

import csv
import json
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import hybrid_tamp
from hybrid_tamp import BlockInstance, InputError, Recording, save_trajectories, trajectory_table
from hybrid_tamp.questions.imitate.segmentation import segment
from hybrid_tamp.questions.imitate.transfer import transfer
from hybrid_tamp.taskfile.pose_tables import read_poses

Command = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "roll"
    hybrid_tamp.run("roll_cylinder", folder, backend="analytic")
    return folder


@pytest.fixture(scope="module")
def rolled(folder: Path) -> Recording:
    return hybrid_tamp.load_recording(folder / "recording.npz")


def test_the_columns_are_the_poses_of_all_tokens_except_places(rolled: Recording) -> None:
    pose = ("x", "y", "z", "qx", "qy", "qz", "qw")
    table = trajectory_table(rolled)
    assert list(table) == ["time", *(f"{token}.{part}" for token in ("hand", "drum") for part in pose)]
    np.testing.assert_array_equal(table["time"], rolled.times)
    np.testing.assert_array_equal(table["drum.z"], rolled.trajectory["drum", "position"][:, 2])
    np.testing.assert_array_equal(table["drum.qw"], rolled.trajectory["drum", "orientation"][:, 3])


def test_the_table_is_a_copy(rolled: Recording) -> None:
    before = rolled.times[0], rolled.states[0, 0]
    for column in trajectory_table(rolled).values():
        column += 1.0
    assert before == (rolled.times[0], rolled.states[0, 0])


def test_a_property_with_one_component_has_a_column(rolled: Recording) -> None:
    task = hybrid_tamp.load_task("hammer_strike")
    states = np.stack([task.state.values, task.state.values + 0.125])
    held = BlockInstance("HOLDING-1", "HOLDING", {"hand": "hand"}, 0.0, 1.0)
    recording = replace(rolled, layout=task.state.layout, times=np.arange(2.0), states=states, instances=(held,))
    table = trajectory_table(recording)
    np.testing.assert_array_equal(table["hand.aperture"], recording.trajectory["hand", "aperture"][:, 0])
    assert {column.partition(".")[0] for column in table} == {"time", "hand"}
    assert not [column for column in table if "velocity" in column]


def test_pandas_reads_the_table_and_the_file(rolled: Recording, tmp_path: Path) -> None:
    save_trajectories(rolled, tmp_path / "roll.csv")
    frame = pd.DataFrame(trajectory_table(rolled))
    # Some versions of pandas change the last bit of a number, but the file has all digits.
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "roll.csv"), frame, rtol=1e-14, atol=1e-15)
    with (tmp_path / "roll.csv").open(encoding="utf-8", newline="") as file:
        names, *rows = csv.reader(file)
    assert names == list(frame)
    np.testing.assert_array_equal(np.array(rows, dtype=float), frame.to_numpy())
    assert frame.set_index("time")["drum.x"].iloc[-1] == pytest.approx(0.7, abs=0.03)


def test_imitate_reads_the_same_states(rolled: Recording, tmp_path: Path) -> None:
    save_trajectories(rolled, tmp_path / "roll.csv")
    times, states, noise = read_poses(tmp_path / "roll.csv", hybrid_tamp.load_task("roll_cylinder"))
    np.testing.assert_allclose(times, rolled.times, atol=1e-12)
    for token in ("hand", "drum", "goal"):
        for name in ("position", "orientation"):
            np.testing.assert_allclose(states[token, name], rolled.trajectory[token, name], atol=1e-9)
    np.testing.assert_allclose(noise.values, 0.0, atol=1e-3)


def test_another_agent_imitates_the_exported_run(folder: Path, tmp_path: Path, command: Command) -> None:
    table = tmp_path / "roll.csv"
    done = command("report", folder, "--csv", table, "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["csv"] == str(table)
    done = command("report", folder, "--csv", table)
    assert done.returncode == 30
    assert "the file for the trajectories must not exist yet; got an existing file" in done.stderr
    shown = hybrid_tamp.read_shown(table, hybrid_tamp.load_task("roll_cylinder"))
    other = hybrid_tamp.load_task("roll_by_another_agent")
    found = segment(shown.task, shown.observation)
    assert not found.unexplained
    moved = transfer(shown.task, found.plan, other)
    assert moved.roles == {"hand": "paddle", "drum": "barrel", "goal": "yard"}
    assert hybrid_tamp.check_law(other, moved.plan) == []


def test_a_folder_without_a_run_has_no_trajectories(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"recording\.npz: not a recording of a run"):
        save_trajectories(tmp_path, tmp_path / "none.csv")
