"""A camera that shows all tokens during a whole run."""

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.geometry.meshes import Hull
from hybrid_tamp.geometry.shapes import Box, Cylinder, Solid, solids_of
from hybrid_tamp.geometry.triangles import placed_solid
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate

FIELD_OF_VIEW = np.radians(32.0)
"""Vertical angle of view [rad]."""
ELEVATION = np.radians(26.0)
"""Angle of the camera above the horizontal [rad]."""
TURN = np.radians(13.0)
"""Horizontal angle between the view and the normal of the motion [rad]. The angle gives the picture depth."""
SPARE = 1.06
"""Factor by which the camera's distance is increased, so that the picture has a margin around the spheres."""
_DISC = 0.05
_ROWS = 200
_STILL = 1e-3
_LEVEL = 1e-2
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Camera:
    """A perspective camera.

    Attributes:
        eye: position of the camera in the world frame, ``(3,)`` [m].
        target: point at the centre of the picture in the world frame, ``(3,)`` [m].
    """

    eye: FloatArray
    target: FloatArray

    @property
    def distance(self) -> float:
        """Distance from the eye to the target [m]."""
        return float(np.linalg.norm(self.eye - self.target))


@dataclass(frozen=True, eq=False)
class Spheres:
    """Spheres that a picture must show. Centres ``(n, 3)`` [m] in the world frame, and radii ``(n,)`` [m]."""

    centres: FloatArray
    radii: FloatArray

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper corner of the axis-aligned box around all spheres, each ``(3,)`` [m]."""
        reach = self.radii[:, None]
        return (self.centres - reach).min(axis=0), (self.centres + reach).max(axis=0)


def spheres_of(task: Task, recording: Recording) -> Spheres:
    """Return points that a picture of the run must show: the corners of boxes around tokens at up to 200 instants.

    Tokens that take no part in the run are left out, so that a distant object does not make the action small.
    """
    rows = np.unique(np.linspace(0, len(recording.times) - 1, _ROWS).astype(int))
    run = State(recording.layout, recording.states[rows])
    names = find_actors(task, recording)
    seen = [token for token in task.tokens if token.name in names or not names]
    corners = np.concatenate([_corners(token, run).reshape(-1, 3) for token in seen])
    return Spheres(corners, np.zeros(len(corners)))


def find_actors(task: Task, recording: Recording) -> frozenset[str]:
    """Return the names of all tokens that move, that blocks other than resting contain, or that the goal names."""
    run = recording.trajectory
    poses = [("position", _STILL), ("orientation", _LEVEL)]
    moved = {
        token.name
        for token in task.tokens
        for name, least in poses
        if (token.name, name) in run.layout.slices and np.ptp(run[token, name], axis=0).max() > least
    }
    busy = [each for each in recording.instances if each.block != task.domain.resting]
    named = {name for each in busy for name in each.roles.values()}
    named |= {str(name) for atom in task.goal for name in atom.arguments}
    return frozenset((moved | named) & set(task.token_by_name))


def _corners(token: Token, run: State) -> FloatArray:
    """Return the corners of the token's bounding box in each state of a batch, shape ``(t, n, 3)`` [m]."""
    signs = np.array(list(product((-1, 1), repeat=3)), dtype=float)
    position = run[token, "position"][:, None]
    if token.shape is None:
        return position * [1.0, 1.0, 0.0] + disc_radius(token) * signs * [1.0, 1.0, 0.0]
    middle, half = bounding_box(token)
    return position + rotate(run[token, "orientation"][:, None], middle + signs * half)


def bounding_box(token: Token) -> tuple[FloatArray, FloatArray]:
    """Return the centre and the half extents of a token's bounding box in its body frame, each ``(3,)`` [m]."""
    vertices = np.concatenate([placed_solid(each).vertices for each in solids_of(token.solid)])
    lower, upper = vertices.min(axis=0), vertices.max(axis=0)
    return (lower + upper) / 2, (upper - lower) / 2


def bounding_radius(token: Token) -> float:
    """Return the radius [m] of a sphere about a token's origin that contains all meshes of the token."""
    if token.shape is None:
        return disc_radius(token)
    return max(float(np.linalg.norm(each.position)) + _radius(each) for each in solids_of(token.shape))


def _radius(shape: Solid | Hull) -> float:
    if isinstance(shape, Hull):
        return float(np.linalg.norm(shape.vertices, axis=1).max())
    if isinstance(shape, Cylinder):
        return float(np.hypot(shape.radius, shape.length / 2))
    if isinstance(shape, Box):
        return float(np.linalg.norm(shape.half_extents))
    return shape.radius


def disc_radius(token: Token) -> float:
    """Return the radius [m] of the disc that is drawn for a token without a shape."""
    radius = token.properties.get("radius", _DISC)
    return float(radius)


def frame_camera(spheres: Spheres, aspect: float, turn: float = TURN, elevation: float = ELEVATION) -> Camera:
    """Return the nearest camera that shows all spheres. The longest extent of the spheres appears horizontal.

    Let (x, y, z) be the centre of a sphere relative to the target, along the axes right, up and backward. Let D be the
    distance from the camera to the target, and let h be half the angle of view. The picture's left edge does not cut
    the sphere if ``D >= z + (radius - x cos h) / sin h``. The other edges give similar bounds. Each bound is linear in
    D and in a shift of the target. So D is smallest if the target is shifted until opposite bounds are equal.

    Args:
        spheres: spheres to show.
        aspect: ratio of the picture's width to its height.
        turn: horizontal angle between the view and the normal of the motion [rad].
        elevation: angle of the camera above the horizontal [rad].
    """
    right, up, back = _axes(spheres.centres, turn, elevation)
    vertical = FIELD_OF_VIEW / 2
    horizontal = np.arctan(np.tan(vertical) * aspect)
    middle = np.mean(spheres.bounds, axis=0)
    offset = spheres.centres - middle
    depth = offset @ back
    target, distances = middle.copy(), []
    for axis, half in ((right, horizontal), (up, vertical)):
        across = offset @ axis
        high, low = (
            float(np.max(depth + (spheres.radii + sign * across * np.cos(half)) / np.sin(half))) for sign in (1, -1)
        )
        target += axis * (high - low) / 2 * np.tan(half)
        distances.append((high + low) / 2)
    return Camera(target + back * max(distances) * SPARE, target)


def _axes(points: NDArray[np.float64], turn: float, elevation: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return unit vectors to the right, up and backward. The points ``(n, 3)`` spread most along the first vector."""
    level = points[:, :2] - points[:, :2].mean(axis=0)
    _, spreads, directions = np.linalg.svd(level, full_matrices=False)
    along = directions[0] if spreads[0] > 1e-9 else np.array([1.0, 0.0])
    # The sign is chosen so that the direction points to positive x, or to positive y if x is zero.
    if (along[0], along[1]) < (-along[0], -along[1]):
        along = -along
    cos, sin = np.cos(turn), np.sin(turn)
    right = np.array([cos * along[0] - sin * along[1], sin * along[0] + cos * along[1], 0.0])
    away = np.cross(_UP, right)
    back = -np.cos(elevation) * away + np.sin(elevation) * _UP
    return right, np.cross(back, right), back
