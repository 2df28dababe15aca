"""Geometric features of shapes, such as the roundness about an axis. The features rank the classes of a new object.

All features derive from the support function h(u), the maximum of the dot product p u over all points p of a body.
h(u) is the reach of the body from the centre of mass along a unit vector u. The support function describes the convex
hull of the body, on which the body rolls and stands.
"""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.geometry.surfaces import outer_surface, points_of
from hybrid_tamp.motion.arrays import FloatArray

_ANGLES = 720
_LEAST_ROUND = float(np.sqrt(0.5))
"""Roundness of a square prism, which cannot roll."""
_LAYER = 0.01
"""Thickness of the layer of points that form a face, as a fraction of the body's extent along the face normal."""


@dataclass(frozen=True)
class RestingPose:
    """A face of the convex hull on which a body rests.

    Attributes:
        down: outward normal of the face in the body frame.
        height: height of the centre of mass above the floor [m].
        share: probability that the body comes to rest on this face after a drop in a random orientation.
    """

    down: tuple[float, float, float]
    height: float
    share: float


def silhouette(points: FloatArray, axis: FloatArray) -> FloatArray:
    """Return the support function for equally spaced directions perpendicular to an axis [m], shape ``(_ANGLES,)``.

    Args:
        points: points of the body in the body frame [m], shape ``(n, 3)``.
        axis: unit vector along the axis, shape ``(3,)``.
    """
    one, other = across(axis)
    angles = np.linspace(0.0, 2.0 * np.pi, _ANGLES, endpoint=False)
    directions = np.cos(angles)[:, None] * one + np.sin(angles)[:, None] * other
    return np.asarray((points @ directions.T).max(axis=0))


def across(axis: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return unit vectors u and v, shape ``(3,)``, for which (u, v, axis) is a right-handed orthogonal system."""
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    one = np.cross(axis, helper)
    one /= np.linalg.norm(one)
    return one, np.asarray(np.cross(axis, one))


def roundness(shape: Shape, axis: FloatArray) -> float:
    """Return the ratio of the smallest to the largest reach perpendicular to an axis, e.g. 1 for a cylinder."""
    reach = silhouette(points_of(shape), axis)
    return float(reach.min() / reach.max())


def rolling_radius(shape: Shape, axis: FloatArray) -> float:
    """Return the distance rolled in a full turn about an axis ``(3,)``, divided by 2 pi [m].

    The result is the mean reach, because the perimeter of a convex outline is 2 pi times its mean reach (Cauchy).
    """
    return float(silhouette(points_of(shape), axis).mean())


def roundest_axis(shape: Shape) -> FloatArray:
    """Return the axis of the body frame about which a shape is roundest, shape ``(3,)``. The longest axis wins ties."""
    points = points_of(shape)
    rated = [(round(roundness(shape, axis), 3), round(float(np.ptp(points @ axis)), 6)) for axis in np.eye(3)]
    return np.asarray(np.eye(3)[rated.index(max(rated))])


def rolling_likelihood(shape: Shape) -> float:
    """Return a score for how well a shape rolls about its roundest axis: 0 for a square prism and 1 for a cylinder."""
    best = roundness(shape, roundest_axis(shape))
    return float(np.clip((best - _LEAST_ROUND) / (1.0 - _LEAST_ROUND), 0.0, 1.0))


def tumbling_likelihood(shape: Shape) -> float:
    """Return the relative size, from 0 to 1, of the smallest face on which a shape stands while it tumbles."""
    points = points_of(shape)
    grounds = np.array([[_ground(points, sign * axis) for sign in (-1.0, 1.0)] for axis in np.eye(3)]).min(axis=1)
    return float(max(np.delete(grounds, turn).min() for turn in range(3)))


def _ground(points: FloatArray, down: FloatArray) -> float:
    """Return the smallest reach of the contact area along the horizontal axes, as a fraction of the body's reach."""
    depth = points @ down
    face = points[depth >= depth.max() - _LAYER * np.ptp(depth)]
    shares = [
        min(side.max() / max(whole.max(), 1e-12), side.min() / min(whole.min(), -1e-12))
        for axis in np.eye(3)
        if abs(axis @ down) < 0.5
        for side, whole in ((face @ axis, points @ axis),)
    ]
    return float(np.clip(min(shares), 0.0, 1.0))


def resting_poses(shape: Shape, least: float = 0.01) -> tuple[RestingPose, ...]:
    """Return the faces on which a shape can rest, the likeliest face first.

    Args:
        shape: shape whose centre of mass is the origin of the body frame.
        least: smallest probability. Faces with a smaller probability are omitted.
    """
    from trimesh.poses import compute_stable_poses

    hull = outer_surface(shape).convex_hull
    transforms, shares = compute_stable_poses(hull, center_mass=np.zeros(3), sigma=0.0, n_samples=1, threshold=least)
    found = []
    for transform, share in zip(transforms, shares, strict=True):
        x, y, z = (-float(component) for component in transform[2, :3])
        found.append(RestingPose((x, y, z), float(transform[2, 3]), float(share)))
    return tuple(found)
