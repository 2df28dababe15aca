"""Blocks with ``system=PHYSICS``, for which planning and optimisation use a simulator."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from default_domains import shoving_task

import hybrid_tamp
from hybrid_tamp.authoring import PHYSICS
from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.arrival import Arrivals, roll_out_to_exit
from hybrid_tamp.model.forward_model import roll_out
from hybrid_tamp.model.simulated import pass_simulator
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.skills import BODY, MOTION
from hybrid_tamp.testing import check_domain

ROLES = {"hand": "hand", "object": "crate", "region": "goal"}


def make_task() -> Task:
    return shoving_task(system=PHYSICS, writes={"hand": MOTION, "object": BODY})


def simulated() -> Task:
    return pass_simulator(make_task(), partial(open_backend, "pybullet"))


def roll(task: Task, durations: list[float]) -> Arrivals:
    block, binding = task.domain.block_by_name["SHOVING"], task.bind(ROLES)
    behind = task.state.replace({("hand", "position"): (-0.14, 0.0, 0.08)})
    starts = State(behind.layout, np.repeat(behind.values[None], len(durations), axis=0))
    return roll_out_to_exit(block, binding, starts, {"duration": np.array(durations)})


def test_a_simulated_block_is_planned_optimised_and_run(tmp_path: Path) -> None:
    task = simulated()
    assert hybrid_tamp.run(make_task(), tmp_path).success
    recording = hybrid_tamp.load_recording(tmp_path / "recording.npz")
    (moved,) = [each for each in recording.instances if each.block == "SHOVING"]
    block, binding = task.domain.block_by_name["SHOVING"], task.bind(moved.roles)
    predicted = roll_out(block, binding, recording.at(moved.start), block.duration.maximum)
    away = predicted[-1]["crate", "position"] - recording.at(moved.end)["crate", "position"]
    assert np.linalg.norm(away) < 0.005
    assert len(predicted) / 240 == pytest.approx(moved.end - moved.start, abs=0.05)


def test_equal_rollouts_have_equal_bits_and_rows_do_not_touch_each_other() -> None:
    both, again, alone = (roll(simulated(), each) for each in ([1.5, 3.0], [1.5, 3.0], [3.0]))
    np.testing.assert_array_equal(both.ends.values, again.ends.values)
    np.testing.assert_array_equal(both.ends.values[1], alone.ends.values[0])
    assert both.steps[0] < both.steps[1]
    assert both.steps[1] == alone.steps[0]


def test_the_check_of_the_domain_reports_nothing() -> None:
    assert check_domain(make_task(), samples=2) == []


def test_a_block_without_its_simulator_says_what_is_missing() -> None:
    with pytest.raises(DomainError, match="PHYSICS requires a simulator"):
        roll(make_task(), [2.0])
