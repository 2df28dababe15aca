"""The replay of a recording is bit-identical, and a changed recording is detected."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hybrid_tamp.errors import InputError
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.execution.replay import replay
from hybrid_tamp.physics.protocol import open_backend


def recorded(toys: Any, name: str = "pybullet") -> Any:
    # The initial orientation is oblique, because Bullet would not return such a quaternion bit-identically.
    world = toys.world.pusher(orientation=np.array([0.18, 0.36, 0.54, 0.74]) / np.linalg.norm([0.18, 0.36, 0.54, 0.74]))
    task = world.spot().task()
    with open_backend(name) as backend:
        return task, execute(task, toys.one_move(), backend)


def again(task: Any, recording: Any) -> Any:
    with open_backend(recording.backend) as backend:
        return replay(task, recording, backend)


@pytest.mark.parametrize("name", ["analytic", "pybullet"])
def test_replay_is_bit_identical(toys: Any, name: str) -> None:
    task, recording = recorded(toys, name)
    report = again(task, recording)
    assert report.identical
    assert report.first_difference is None
    assert report.steps == len(recording.commands)


@pytest.mark.parametrize("name", ["analytic", "pybullet"])
def test_tampered_command_is_found_at_the_step_after_it(toys: Any, name: str) -> None:
    task, recording = recorded(toys, name)
    commands = recording.commands.copy()
    commands[100, 0] += 1e-3
    report = again(task, replace(recording, commands=commands))
    assert not report.identical
    assert report.first_difference.time == recording.times[101]
    assert report.first_difference.token == "pusher"
    assert report.first_difference.property in ("velocity", "position")
    assert report.first_difference.size > 0


def test_tampered_state_is_found_down_to_the_last_bit(toys: Any) -> None:
    task, recording = recorded(toys)
    states = recording.states.copy()
    part = recording.layout.slices["spot", "position"]
    states[50, part.start] = np.nextafter(states[50, part.start], 1.0)
    states[60, part.start + 1] = -0.0
    report = again(task, replace(recording, states=states))
    assert (report.first_difference.time, report.first_difference.token) == (recording.times[50], "spot")
    states[50] = recording.states[50]
    report = again(task, replace(recording, states=states))
    assert report.first_difference.time == recording.times[60]
    assert report.first_difference.size == 0.0


def test_command_that_the_backend_refuses_is_reported(toys: Any) -> None:
    task, recording = recorded(toys)
    commands = recording.commands.copy()
    commands[100] = 1e6
    report = again(task, replace(recording, commands=commands))
    assert not report.identical
    assert report.first_difference is None
    assert "force on pusher" in report.refusal


def test_recording_of_another_task_or_backend_is_refused(toys: Any) -> None:
    task, recording = recorded(toys)
    other = toys.world.pusher("somebody else").spot().task()
    with pytest.raises(InputError, match="other tokens"):
        again(other, recording)
    with open_backend("analytic") as backend, pytest.raises(InputError, match="got pybullet"):
        replay(task, recording, backend)
