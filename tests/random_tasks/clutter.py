"""Scenes with fixed obstacles, for trials: a random task with walls and blocks at random or tidy poses."""

import numpy as np

from hybrid_tamp.geometry.convex import placed
from hybrid_tamp.geometry.overlaps import overlap
from hybrid_tamp.geometry.shapes import Box
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.poses import quaternion_from_rpy

MOST = 6
"""Largest number of obstacles."""
_TIDY = 0.05
"""Distance of the positions in tidy scenes [m]."""
_FARTHEST = 1.2
"""Largest coordinate of a position [m]."""
_TRIES = 50


def add_clutter(task: Task, seed: int) -> Task:
    """Return the task with 0 to 6 fixed boxes that stand on the floor within 1.2 m and overlap nothing.

    Half edges U(0.03, 0.25) m, half heights U(0.05, 0.5) m, any yaw. Every third scene is tidy: positions and edges are
    multiples of 5 cm, and yaws are multiples of 90 degrees.
    """
    rng = np.random.default_rng([seed, 17])
    tidy = seed % 3 == 0
    bodies = [
        placed(token.shape, task.state[token, "position"], task.state[token, "orientation"])
        for token in task.tokens
        if token.shape is not None
    ]
    tokens, given = list(task.tokens), dict(_values(task))
    for _ in range(int(rng.integers(0, MOST + 1))):
        for _ in range(_TRIES):
            halves, place, yaw = _draw(rng, tidy)
            shape, turn = Box(kind="box", half_extents=halves), quaternion_from_rpy(np.array([0.0, 0.0, yaw]))
            body = placed(shape, place, turn)
            if all(overlap(body, other) is None for other in bodies):
                bodies.append(body)
                wall = Token.make(f"wall-{len(tokens)}", [], {}, shape, immovable=True)
                tokens.append(wall)
                given[wall.name, "position"], given[wall.name, "orientation"] = place, turn
                break
    return task.replaced(name=f"clutter_{task.name}", tokens=tuple(tokens), state=State.of(tokens, given))


def _values(task: Task) -> dict[tuple[str, str], np.ndarray]:
    return {(token, name): task.state[token, name] for token, name, _ in task.state.layout.entries}


def _draw(rng: np.random.Generator, tidy: bool) -> tuple[tuple[float, float, float], np.ndarray, float]:
    """Return half extents [m], a position ``(3,)`` [m] and a yaw [rad]."""
    halves = (*rng.uniform(0.03, 0.25, 2), rng.uniform(0.05, 0.5))
    x, y = rng.uniform(-_FARTHEST, _FARTHEST, 2)
    yaw = rng.uniform(-np.pi, np.pi)
    if tidy:
        halves = tuple(max(_TIDY, round(half / _TIDY) * _TIDY) for half in halves)
        x, y = round(x / _TIDY) * _TIDY, round(y / _TIDY) * _TIDY
        yaw = round(yaw / (np.pi / 2)) * np.pi / 2
    a, b, c = (float(half) for half in halves)
    return (a, b, c), np.array([x, y, c]), float(yaw)
