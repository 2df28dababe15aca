"""The camera of a run: near the action, and on a side from which bodies do not hide each other."""

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, rotate
from hybrid_tamp.physics.pictures.camera import ELEVATION, TURN, Camera, frame_camera
from hybrid_tamp.physics.pictures.outlines import bounding_box
from hybrid_tamp.physics.pictures.subject import find_actors, sample_states, spheres_of

_FRONT = {
    **{TURN: 1.0, -TURN: 1.0},
    **{sign * np.radians(turn): worth for turn, worth in ((30.0, 0.88), (45.0, 0.8), (60.0, 0.7)) for sign in (1, -1)},
}
_BACK = 0.5
TURNS = {**_FRONT, **{turn + np.pi: _BACK * worth for turn, worth in _FRONT.items()}}
"""Maps each horizontal angle of the camera that is tried [rad] to its worth. Motion across the picture is preferred,
from the front. A view from the back is only worth while if something hides the action from the front."""
ELEVATIONS = {ELEVATION: 1.0, np.radians(36.0): 1.0, np.radians(60.0): 0.4}
"""Maps each angle of the camera above the horizontal that is tried [rad] to its worth."""
_ROWS = 16
_INSIDE = 0.85
_ENOUGH = 0.45
_CLARITY = 4
_FARTHER = 1.6


@dataclass(frozen=True, eq=False)
class Shot:
    """A camera for a run, with its quality. The quality is higher if the bodies are larger and hide each other less."""

    camera: Camera
    quality: float


def choose_shot(task: Task, recording: Recording, aspect: float) -> Shot:
    """Return the best camera that shows all that moves or takes part in the run.

    Args:
        task: the task of the run.
        recording: the recording of the run.
        aspect: ratio of the picture's width to its height.
    """
    names = find_actors(task, recording)
    seen, everything = (spheres_of(task, recording, each) for each in (names, task.token_by_name))
    # Other tokens are shown too, unless this makes the action much smaller.
    if frame_camera(everything, aspect).distance <= _FARTHER * frame_camera(seen, aspect).distance:
        seen = everything
    states = sample_states(recording, _ROWS)

    def shoot(turn: float, elevation: float) -> Shot:
        camera = frame_camera(seen, aspect, turn, elevation)
        visible = visible_share(task, states, sorted(names), camera.eye)
        return Shot(camera, TURNS[turn] * ELEVATIONS[elevation] * visible**_CLARITY / camera.distance)

    return max((shoot(*angles) for angles in product(TURNS, ELEVATIONS)), key=lambda shot: shot.quality)


def visible_share(task: Task, states: State, names: list[str], eye: FloatArray) -> float:
    """Return how much of the bodies an eye sees in a batch of states, from 0 (nothing) to 1 (enough of each body).

    The points of a body are its centre and points near the corners of its bounding box. A point is hidden if the
    bounding box of any other body of the task is between the point and the eye. Nearly half the points of a body are
    enough.
    """
    tokens = [task.token_by_name[name] for name in names if task.token_by_name[name].shape is not None]
    boxes = {token.name: bounding_box(token) for token in task.tokens if token.shape is not None}
    signs = np.array([(0.0, 0.0, 0.0), *product((-_INSIDE, _INSIDE), repeat=3)])
    shares = []
    for token in tokens:
        middle, half = boxes[token.name]
        points = rotate(states[token.name, "orientation"][:, None], middle + signs * half)
        points = points + states[token.name, "position"][:, None]
        hidden = np.zeros(points.shape[:-1], dtype=bool)
        for other, box in boxes.items():
            if other != token.name:
                hidden |= _is_hidden(points, eye, states, other, *box)
        shares.append(np.minimum((1.0 - hidden.mean(axis=-1)) / _ENOUGH, 1.0).mean())
    return float(np.mean(shares)) if shares else 1.0


def _is_hidden(
    points: FloatArray, eye: FloatArray, states: State, token: str, middle: FloatArray, half: FloatArray
) -> NDArray[np.bool_]:
    """Return which points ``(t, n, 3)`` [m] are behind the bounding box of a token."""
    to_body = quaternion_conjugate(states[token, "orientation"])[:, None]
    position = states[token, "position"][:, None]
    start = rotate(to_body, eye - position) - middle
    path = rotate(to_body, points - position) - middle - start
    # The path crosses the box where it is between all three pairs of opposite faces.
    path = np.where(np.abs(path) < 1e-12, 1e-12, path)
    near, far = (-half - start) / path, (half - start) / path
    enter = np.minimum(near, far).max(axis=-1)
    leave = np.minimum(np.maximum(near, far).min(axis=-1), 1.0)
    return np.asarray((enter < leave) & (enter > 0.0) & (enter < 1.0))
