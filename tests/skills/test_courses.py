"""The courses that the makers of blocks declare: key poses, and movements that no course tells."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scenes import rolling_task

import hybrid_tamp
from hybrid_tamp.authoring import Course, Parameters, SweepMaker, sample_times
from hybrid_tamp.errors import DomainError
from hybrid_tamp.model.expectation import declared_course
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.skills import STANDOFF

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def course_of(
    task: Task, block: str, roles: dict[str, str], state: State | None = None, **values: float
) -> Course | None:
    """Return the course of a block, with the initial values of all hyperparameters that are not given."""
    block_, binding = task.domain.block_by_name[block], task.bind(roles)
    start = task.state if state is None else state
    chosen = block_.initial_values(binding, start) | {name: np.asarray(value) for name, value in values.items()}
    return declared_course(block_, binding, start, Parameters(chosen))


def gap(state: State) -> FloatArray:
    return np.asarray(state["drum 0", "position"][..., 0] - state["hand 0", "position"][..., 0])


def test_the_course_of_a_push_has_its_start_the_contact_and_its_end() -> None:
    task = rolling_task()
    roles = {"hand": "hand 0", "object": "drum 0", "region": "region 0"}
    reach = course_of(task, "REACHING:behind", roles)
    assert reach is not None
    roll = course_of(task, "ROLLING", roles, reach.end, distance=0.5)
    assert roll is not None
    poses = State(roll.states.layout, roll.states.values[[0, 1, -1]])
    start, contact, end = gap(poses)
    assert start - contact == pytest.approx(STANDOFF, abs=1e-3)
    assert contact == pytest.approx(0.1 + 0.035, abs=1e-3)
    assert end == pytest.approx(contact)
    moved = poses["drum 0", "position"] - task.state["drum 0", "position"]
    np.testing.assert_allclose(moved, [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.5, 0.0, 0.0]], atol=1e-9)


def test_a_block_that_moves_nothing_stays_where_it_is() -> None:
    task = rolling_task()
    course = course_of(task, "RESTING", {"token": "drum 0"})
    assert course is not None
    np.testing.assert_array_equal(course.states.values, task.state.values[None])


def test_no_course_tells_where_an_object_falls() -> None:
    task = hybrid_tamp.load_task(EXAMPLES / "sweeping" / "task.yaml")
    crumb = next(token.name for token in task.tokens if "CRUMB" in {each.name for each in token.classes})
    hand = next(token.name for token in task.tokens if token.basic_actions)
    roles = {"hand": hand, "object": crumb, "table": "table", "tray": "tray"}
    assert course_of(task, "SWEEPING", roles) is None
    short = course_of(task, "SWEEPING", roles, distance=0.01)
    assert short is not None
    assert short.end[crumb, "position"][2] == pytest.approx(task.state[crumb, "position"][2])


def test_a_sweep_of_the_wrong_shape_is_an_error_of_the_domain() -> None:
    task = rolling_task()

    def wrong(binding: Any, start: State, parameters: Parameters) -> Course:
        return Course(start)

    sweep: SweepMaker = wrong
    block = replace(task.domain.block_by_name["ROLLING"], sweep=sweep)
    binding = task.bind({"hand": "hand 0", "object": "drum 0", "region": "region 0"})
    with pytest.raises(DomainError, match=r"ROLLING\.sweep"):
        declared_course(block, binding, task.state, Parameters({}))


def test_samples_include_both_ends() -> None:
    times = sample_times(0.1)
    assert (times[0], times[-1]) == (0.0, 0.1)
    assert np.all(np.diff(times) <= 8 / 240 + 1e-9)
    assert len(sample_times(0.0)) == 2
