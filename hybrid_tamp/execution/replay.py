"""Replay of a recording: the recorded commands are simulated again, and the states are compared bit by bit."""

import math
from collections.abc import Iterable

import numpy as np

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.commands import CommandError, CommandLayout
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.plan import TIME_TOLERANCE, BlockInstance
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.run_result import ReplayResult, StateDifference
from hybrid_tamp.model.state import State, StateLayout
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import Backend


def replay(task: Task, recording: Recording, backend: Backend, deadline: Deadline = NEVER) -> ReplayResult:
    """Simulate the recorded commands from the recorded initial state, and compare the states.

    Args:
        task: task of the recorded run.
        recording: recording to repeat.
        backend: backend with the same name and time step as that of the recorded run.
        deadline: deadline of the command.

    Raises:
        LimitReached: the deadline passes.
        InputError: the recording was made with another task or backend, or the backend cannot simulate the task.
    """
    layout = CommandLayout.of(task)
    _check_origin(task, recording, backend, layout)
    state = backend.reset(task, recording.state(0))
    rows = len(recording.commands)
    assigned: tuple[BlockInstance, ...] | None = None
    for index in range(rows + 1):
        difference = _compare(state, recording.state(index), float(recording.times[index]))
        if difference is not None or index == rows:
            return ReplayResult(difference is None, index, difference)
        running = tuple(_find_running(recording, float(recording.times[index])))
        if running != assigned:
            backend.assign(running)
            assigned = running
        deadline.check()
        try:
            state = backend.step(layout.commands(recording.commands[index]))
        except CommandError as error:
            return ReplayResult(False, index, None, f"at {recording.times[index]:.3f} s: {error}")
    raise AssertionError("the loop must return at the last row")


def _check_origin(task: Task, recording: Recording, backend: Backend, layout: CommandLayout) -> None:
    same = recording.layout == StateLayout.of(task.tokens) and recording.commands_layout == layout.entries
    if not same:
        wanted = f"expected the tokens and properties of task {task.name}"
        raise InputError([Issue("recording", wanted, "other tokens or properties", remedy="replay the recorded task")])
    mine, theirs = (backend.name, backend.timestep), (recording.backend, recording.timestep)
    if mine != theirs:
        wanted = f"expected the backend {mine[0]} with a time step of {mine[1]:.6f} s"
        raise InputError([Issue("recording", wanted, f"{theirs[0]} with a time step of {theirs[1]:.6f} s")])


def _find_running(recording: Recording, time: float) -> Iterable[BlockInstance]:
    for instance in recording.instances:
        if instance.start - TIME_TOLERANCE <= time < instance.end - TIME_TOLERANCE:
            yield instance


def _compare(mine: State, theirs: State, time: float) -> StateDifference | None:
    # Bytes are compared, because 0.0 and -0.0 are equal as numbers.
    if mine.values.tobytes() == theirs.values.tobytes():
        return None
    sizes = {
        key: float(np.max(np.abs(mine.values[part] - theirs.values[part])))
        for key, part in mine.layout.slices.items()
        if mine.values[part].tobytes() != theirs.values[part].tobytes()
    }
    token, name = max(sizes, key=lambda key: math.inf if math.isnan(sizes[key]) else sizes[key])
    return StateDifference(time, token, name, sizes[token, name])
