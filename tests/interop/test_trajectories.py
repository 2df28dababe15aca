"""Trajectories of recordings are tables that pandas and the verb `imitate` read."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import hybrid_tamp
from hybrid_tamp import BlockInstance, InputError, Recording, Task, TaskPlan, save_trajectories, trajectory_table
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.execution.storage import save
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.taskfile.pose_tables import read_poses


@pytest.fixture(scope="module")
def rolled(planned: tuple[Task, TaskPlan]) -> Recording:
    with open_backend("analytic") as physics:
        return execute(*planned, physics)


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


def test_the_folder_of_a_run_has_the_same_trajectories(rolled: Recording, tmp_path: Path) -> None:
    save(rolled, tmp_path / "recording.npz")
    save_trajectories(rolled, tmp_path / "one.csv")
    save_trajectories(tmp_path, tmp_path / "other.csv")
    assert (tmp_path / "one.csv").read_bytes() == (tmp_path / "other.csv").read_bytes()


def test_a_file_is_replaced_only_by_force(rolled: Recording, tmp_path: Path) -> None:
    (tmp_path / "roll.csv").write_text("mine")
    with pytest.raises(InputError, match="the file for the trajectories must not exist yet; got an existing file"):
        save_trajectories(rolled, tmp_path / "roll.csv")
    assert (tmp_path / "roll.csv").read_text() == "mine"
    save_trajectories(rolled, tmp_path / "roll.csv", force=True)
    assert (tmp_path / "roll.csv").read_text().startswith("time,hand.x,hand.y,hand.z,hand.qx")


def test_a_folder_without_a_run_has_no_trajectories(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"recording\.npz: there is no recording of a run"):
        save_trajectories(tmp_path, tmp_path / "none.csv")
