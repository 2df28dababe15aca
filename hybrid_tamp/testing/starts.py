"""States from which the check of a domain starts: the initial state of a task, with moved and turned tokens."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import ArrayLike

from hybrid_tamp.geometry.convex import CONTACT, lowest_height, placed
from hybrid_tamp.geometry.overlaps import overlaps
from hybrid_tamp.model.authored import authored
from hybrid_tamp.model.grasp import pass_through
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rotation_vector, quaternion_multiply, rotate

_ATTEMPTS = 30
_HALVINGS = 7
"""Number of possible sizes of a displacement. Each size is half the previous size."""
_SHIFT = 0.5
"""Largest displacement of a token along each horizontal axis [m]."""
_RISE = 0.05
"""Largest vertical displacement of a token with basic actions [m]. Other tokens keep their height."""


def draw_start(task: Task, rng: np.random.Generator, allowed: Callable[[State], bool]) -> State:
    """Return a state in which the tokens are displaced and turned about vertical axes.

    The whole scene is turned about its centre. Then each token is displaced and turned. The sizes of the three
    movements are drawn independently, because conditions often allow a large displacement with a small turn, or a large
    turn with a small displacement.

    Args:
        task: task whose initial state is changed.
        rng: random generator.
        allowed: function that returns whether the conditions of the domain allow a state.

    Returns:
        The first drawn state that is allowed, has no overlaps and is consistent with the tokens' classes. If there is
        no such state, the initial state of the task.
    """
    for _ in range(_ATTEMPTS):
        state = _moved(task, rng)
        if _is_sound(task, state) and allowed(state):
            return state
    return task.state


def _moved(task: Task, rng: np.random.Generator) -> State:
    whole, shift, own = 2.0 ** -rng.integers(0, _HALVINGS, 3)
    turn = _about_vertical(rng.uniform(-np.pi, np.pi) * whole)
    centre = np.mean([task.state[token, "position"] for token in task.tokens], axis=0)
    changes: dict[tuple[str, str], ArrayLike] = {}
    for token in task.tokens:
        position, orientation = task.state[token, "position"], task.state[token, "orientation"]
        offset, yaw = rng.uniform(-1.0, 1.0, 3) * (_SHIFT, _SHIFT, _RISE) * shift, rng.uniform(-np.pi, np.pi) * own
        if token.place:
            offset, yaw = np.zeros(3), 0.0
        elif not token.basic_actions:
            offset[2] = 0.0
        changes[token.name, "position"] = centre + rotate(turn, position - centre) + offset
        changes[token.name, "orientation"] = quaternion_multiply(
            _about_vertical(yaw), quaternion_multiply(turn, orientation)
        )
    return task.state.replace(changes)


def _about_vertical(angle: float) -> FloatArray:
    return quaternion_from_rotation_vector(np.array([0.0, 0.0, angle]))


def _is_sound(task: Task, state: State) -> bool:
    """Return whether no body overlaps the floor or another body, and the tokens' classes accept the state."""
    solid = [token for token in task.tokens if token.shape is not None and not token.place]
    bodies = [placed(token.solid, state[token, "position"], state[token, "orientation"]) for token in solid]
    if any(lowest_height(body) < -CONTACT for body in bodies):
        return False
    if any(overlaps(bodies, lambda one, other: pass_through(solid[one], solid[other]))):
        return False
    for token in task.tokens:
        for member in token.classes:
            with authored(f"{member.name}.consistent_start", {"token": token}):
                if member.consistent_start(token, state, task.tokens) is not None:
                    return False
    return True


def displace(state: State, names: Mapping[str, FloatArray]) -> State:
    """Return the state with displaced tokens. `names` maps tokens to displacements [m], shape ``(..., 3)``."""
    return state.replace({(name, "position"): state[name, "position"] + way for name, way in names.items()})
