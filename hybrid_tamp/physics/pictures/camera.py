"""A camera that shows given spheres."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import cross

FIELD_OF_VIEW = np.radians(32.0)
"""Vertical angle of view [rad]."""
ELEVATION = np.radians(26.0)
"""Angle of the camera above the horizontal [rad]."""
TURN = np.radians(13.0)
"""Horizontal angle between the view and the normal of the motion [rad]. The angle gives the picture depth."""
SPARE = 1.06
"""Factor by which the camera's distance is increased, so that the picture has a margin around the spheres."""
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


def frame_camera(spheres: Spheres, aspect: float, turn: float = TURN, elevation: float = ELEVATION) -> Camera:
    """Return the nearest camera that shows all spheres. The longest extent of the spheres appears horizontal.

    Args:
        spheres: spheres to show.
        aspect: ratio of the picture's width to its height.
        turn: horizontal angle between the view and the normal of the motion [rad].
        elevation: angle of the camera above the horizontal [rad].
    """
    return fit_camera(spheres, aspect, _axes(spheres.centres, turn, elevation))


def fit_camera(spheres: Spheres, aspect: float, axes: FloatArray) -> Camera:
    """Return the nearest camera with a given direction that shows all spheres.

    Let (x, y, z) be the centre of a sphere relative to the target, along the axes right, up and backward. Let D be the
    distance from the camera to the target, and let h be half the angle of view. The picture's left edge does not cut
    the sphere if ``D >= z + (radius - x cos h) / sin h``. The other edges give similar bounds. Each bound is linear in
    D and in a shift of the target. So D is smallest if the target is shifted until opposite bounds are equal.

    Args:
        spheres: spheres to show.
        aspect: ratio of the picture's width to its height.
        axes: unit vectors to the right, up and backward in the world frame, as rows of shape ``(3, 3)``.
    """
    right, up, back = axes
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


def _axes(points: NDArray[np.float64], turn: float, elevation: float) -> FloatArray:
    """Return unit vectors to the right, up and backward, as rows of shape ``(3, 3)``.

    The points ``(n, 3)`` spread most along the first vector.
    """
    level = points[:, :2] - points[:, :2].mean(axis=0)
    _, spreads, directions = np.linalg.svd(level, full_matrices=False)
    along = directions[0] if spreads[0] > 1e-9 else np.array([1.0, 0.0])
    # The sign is chosen so that the direction points to positive x, or to positive y if x is zero.
    if (along[0], along[1]) < (-along[0], -along[1]):
        along = -along
    cos, sin = np.cos(turn), np.sin(turn)
    right = np.array([cos * along[0] - sin * along[1], sin * along[0] + cos * along[1], 0.0])
    away = cross(_UP, right)
    back = -np.cos(elevation) * away + np.sin(elevation) * _UP
    return np.stack([right, cross(back, right), back])
