"""What a picture of a run must show: all that moves, takes part in the run, or is named in the goal."""

from collections.abc import Iterable
from itertools import product

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from hybrid_tamp.model.predicate import ANY, Atom
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate
from hybrid_tamp.physics.pictures.camera import Spheres
from hybrid_tamp.physics.pictures.outlines import bounding_box, bounding_radius, disc_radius, is_raised

_DECIMALS = 5
_STILL = 1e-3
_LEVEL = 1e-2
_BEYOND = 1.2


def spheres_of(task: Task, recording: Recording, names: Iterable[str]) -> Spheres:
    """Return points that a picture must show: the corners of boxes around tokens during the whole run."""
    run = recording.trajectory
    corners = np.concatenate([_corners(task, task.token_by_name[name], run).reshape(-1, 3) for name in sorted(names)])
    points = _extreme_points(corners)
    return Spheres(points, np.zeros(len(points)))


def sample_states(recording: Recording, count: int) -> State:
    """Return up to `count` states of a recording as one batch, batch shape ``(t,)``."""
    rows = np.unique(np.linspace(0, len(recording.times) - 1, count).astype(int))
    return State(recording.layout, recording.states[rows])


def find_actors(task: Task, recording: Recording) -> frozenset[str]:
    """Return the names of all tokens that move, that blocks other than resting contain, or that the goal names.

    If there are none, return the names of all tokens.
    """
    run = recording.trajectory
    moved = {
        token.name
        for token in task.tokens
        for name, least in (("position", _STILL), ("orientation", _LEVEL))
        if (token.name, name) in run.layout.slices and np.ptp(run[token, name], axis=0).max() > least
    }
    busy = [each for each in recording.instances if each.block != task.domain.resting]
    named = {name for each in busy for name in each.roles.values() if name in task.token_by_name}
    return frozenset(moved | named | goal_tokens(task)) or frozenset(task.token_by_name)


def goal_atoms(task: Task) -> tuple[Atom, ...]:
    """Return the atoms of the goal. An atom with a choice is replaced by all its groundings."""
    choices = [task.groundings(atom) if ANY in atom.arguments else (atom,) for atom in task.goal]
    return tuple(atom for atoms in choices for atom in atoms)


def goal_tokens(task: Task) -> frozenset[str]:
    """Return the names of the tokens that the goal names, or that the goal leaves to choose from."""
    return frozenset(name for atom in goal_atoms(task) for name in atom.arguments if name in task.token_by_name)


def goal_reach(task: Task, token: Token) -> float:
    """Return the radius [m] of a circle around a place in the goal, or zero for other places.

    The circle is larger than the objects that the goal requires at the place, so that no object hides the circle.
    """
    wanted = {name for atom in goal_atoms(task) if token.name in atom.arguments for name in atom.arguments}
    sizes = [bounding_radius(each) for each in task.tokens if each.name in wanted]
    return _BEYOND * max(sizes, default=0.0)


def _extreme_points(points: FloatArray) -> FloatArray:
    """Return the corners of the convex hull of points ``(n, 3)``. If all points are in one plane, return all points."""
    distinct = np.unique(np.round(points, _DECIMALS), axis=0)
    try:
        return np.asarray(distinct[ConvexHull(distinct).vertices])
    except QhullError:
        return np.asarray(distinct)


def _corners(task: Task, token: Token, run: State) -> FloatArray:
    """Return the corners of the token's bounding box in each state of a batch, shape ``(t, n, 3)`` [m]."""
    signs = np.array(list(product((-1.0, 1.0), repeat=3)))
    position = run[token, "position"][:, None]
    if token.shape is None:
        level = np.array([1.0, 1.0, 0.0])
        rim = max(disc_radius(token), goal_reach(task, token)) * signs
        return position + rim * level if is_raised(task.state, token) else np.asarray((position + rim) * level)
    middle, half = bounding_box(token)
    return position + rotate(run[token, "orientation"][:, None], middle + signs * half)
