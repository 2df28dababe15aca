"""Tests of the camera that follows the action of a run."""

from dataclasses import replace

import numpy as np
import pytest

from hybrid_tamp.geometry.shapes import Sphere
from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.block import Block, Duration, Slot
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.physics.pictures.sight import choose_shot
from hybrid_tamp.physics.pictures.track import GLIDE, Track, follow
from hybrid_tamp.physics.pictures.view import View

RADIUS, PLACES = 0.1, {"left": 0.0, "right": 4.0}
"""Radius of two balls, and their distances along x [m]."""


def block(name: str) -> Block:
    always = Duration(0.1, 99.0, lambda binding, state, hyperparameters: 1.0)
    return Block(name, (Slot("token", TOKEN),), "token", always, hold=True)


@pytest.fixture
def task() -> Task:
    edges = [("RESTING.token", "WAITING.token"), ("WAITING.token", "RESTING.token")]
    domain = Domain("toy", (), (), (block("RESTING"), block("WAITING")), ReassignmentNetwork(edges))
    tokens = tuple(Token.make(name, [], {}, Sphere(kind="sphere", radius=RADIUS)) for name in PLACES)
    return Task("toy", domain, tokens, State.of(tokens, {}), ())


def run(task: Task, busy: dict[str, tuple[float, float]], end: float) -> Recording:
    """Return a run in which each ball moves by 0.3 m along y while it is busy."""
    times = np.arange(0.0, end + 1e-9, 0.05)
    states = np.tile(task.state.values, (len(times), 1))
    instances = []
    for name, x in PLACES.items():
        first, last = busy[name]
        start = task.state.layout.slices[name, "position"].start
        states[:, start], states[:, start + 2] = x, RADIUS
        states[:, start + 1] = np.interp(times, (first, last), (0.0, 0.3))
        spans = (("RESTING", 0.0, first), ("WAITING", first, last), ("RESTING", last, end))
        for number, (kind, since, until) in enumerate(spans):
            if until > since:
                instances.append(BlockInstance(f"{kind}-{name}-{number}", kind, {"token": name}, since, until))
    return Recording(
        layout=task.state.layout,
        commands_layout=(),
        times=times,
        states=states,
        commands=np.zeros((len(times) - 1, 0)),
        instances=tuple(instances),
        exits={},
        goal=(),
        backend="analytic",
        timestep=0.05,
    )


def overview(task: Task, recording: Recording) -> View:
    return View(choose_shot(task, recording, 1.6).camera, 320, 200)


def shows(view: View, recording: Recording, name: str, time: float) -> bool:
    """Return whether a view shows a whole ball, which is a little smaller in the test."""
    centre = recording.at(time)[name, "position"]
    edge = view.project(centre + 0.95 * RADIUS * np.concatenate([np.eye(3), -np.eye(3)]))
    return bool(np.all(edge >= 0) and np.all(edge <= [view.width, view.height]))


def test_camera_follows_the_busy_tokens_and_shows_all_at_the_end(task: Task) -> None:
    recording = run(task, {"left": (0.0, 4.0), "right": (4.0, 8.0)}, 12.0)
    whole = overview(task, recording)
    track = follow(task, recording, whole)
    distances = [view.camera.distance / whole.camera.distance for view in track.views]
    assert track.changes == (4.0, 8.0)
    assert max(distances[:2]) < 0.4
    assert distances[2] > 0.8
    for time in np.arange(0.0, 12.0, 0.05):
        view = track.at(float(time))
        assert view.axes == pytest.approx(whole.axes), "the camera turns"
        assert shows(view, recording, "left", time) or time > 4.0 - GLIDE / 2
        assert shows(view, recording, "right", time) or not 4.0 + GLIDE / 2 <= time <= 8.0
    assert shows(track.at(12.0), recording, "left", 12.0)
    assert shows(track.at(12.0), recording, "right", 12.0)


def test_camera_stands_still_between_its_movements(task: Task) -> None:
    recording = run(task, {"left": (0.0, 4.0), "right": (4.0, 8.0)}, 12.0)
    track = follow(task, recording, overview(task, recording))
    for first, last, index in ((0.0, 4.0, 0), (4.0, 8.0, 1), (8.0, 12.5, 2)):
        inside = np.linspace(first + GLIDE / 2, last - GLIDE / 2, 9)
        assert all(track.at(float(time)) is track.views[index] for time in inside)
    eyes = np.array([track.at(float(time)).camera.eye for time in np.arange(0.0, 12.0, 1 / 30)])
    assert np.linalg.norm(np.diff(eyes, axis=0), axis=1).max() < 0.2 * np.linalg.norm(np.ptp(eyes, axis=0))


@pytest.mark.parametrize("busy", [{"left": (0.0, 8.0), "right": (0.0, 8.0)}, {"left": (0.0, 4.0), "right": (4.0, 5.0)}])
def test_camera_does_not_move_for_actions_that_are_far_apart_or_short(
    task: Task, busy: dict[str, tuple[float, float]]
) -> None:
    end = max(last for _, last in busy.values())
    recording = run(task, busy, end)
    assert len(follow(task, recording, overview(task, recording)).views) == 1


def test_run_without_steps_is_seen_from_the_overview(task: Task) -> None:
    recording = replace(run(task, {"left": (0.0, 1.0), "right": (0.0, 1.0)}, 1.0), instances=())
    whole = overview(task, recording)
    assert follow(task, recording, whole).at(0.5) is whole
    assert Track((whole,), ()).at(3.0) is whole
