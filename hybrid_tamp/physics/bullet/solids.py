"""The convex solids that represent a body in Bullet.

Bullet adds only one contact point per pair of solids and step, and keeps older points nearby. A level cylinder touches
the floor with two rims. The rim that is lower by rounding errors gets the new point, and the other rim keeps a point of
an earlier step. This older point lies behind the axis, so the force of the floor accelerates the cylinder. The speed
rises from 0.40 to 0.42 m/s in 2 s. A cylinder of a body that may roll is therefore replaced by a core with a thin disc
at each end. Each disc gets a new point in each step. The core is slightly thinner than the discs, and bears the loads
between the discs.
"""

from typing import NamedTuple

import numpy as np

from hybrid_tamp.geometry.meshes import Hull, MeshShape
from hybrid_tamp.geometry.shapes import Compound, Cylinder, CylinderPart, Shape, Solid, solids_of
from hybrid_tamp.motion.poses import quaternion_from_rpy, rotate

_WIDTH = 0.005
"""Width of a disc, as a fraction of half the diagonal of the cylinder's bounding box.

A new contact point replaces older points that are nearer than 0.02 of this length. The two rims of a disc must be
nearer to each other than this distance, because only one rim gets the new point.
"""
_GAP = 1e-4
"""Difference between the radii of the discs and the core [m]."""
_THINNEST = 0.98
"""Smallest radius of a core, as a fraction of the cylinder's radius."""


class Placed(NamedTuple):
    """A solid, and its pose in the body frame: position ``(3,)`` [m] and unit quaternion ``(4,)``."""

    solid: Solid
    position: tuple[float, ...]
    orientation: tuple[float, ...]


def place_solids(shape: Solid | Compound, rolls: bool) -> list[Placed]:
    """Return the solids of a shape with their poses.

    Args:
        shape: shape of the body.
        rolls: whether the body can roll freely, so that each cylinder must have a disc at each end.
    """
    placed = []
    for part in solids_of(shape):
        assert not isinstance(part, Hull), "hulls are loaded from a file"
        pieces = _split(part) if rolls and isinstance(part, CylinderPart) else [(part, 0.0)]
        orientation = quaternion_from_rpy(part.rpy)
        axis = rotate(orientation, np.array([0.0, 0.0, 1.0]))
        for solid, along in pieces:
            position = tuple((part.position + along * axis).tolist())
            placed.append(Placed(solid, position, tuple(orientation.tolist())))
    return placed


def is_compound(shape: Shape, rolls: bool) -> bool:
    """Return whether Bullet represents a shape by a compound. See `place_solids` for the arguments."""
    return isinstance(shape, Compound | MeshShape) or len(place_solids(shape, rolls)) > 1


def _split(cylinder: Cylinder) -> list[tuple[Solid, float]]:
    """Return pairs of a solid and the position of its centre on the cylinder's axis [m].

    A cylinder so short that its two rims share a contact point stays the same.
    """
    radius, length = cylinder.radius, cylinder.length
    width = _WIDTH * float(np.sqrt(2.0 * radius**2 + length**2 / 4.0))
    if length < 4.0 * width:
        return [(cylinder, 0.0)]
    core = Cylinder(kind="cylinder", radius=max(radius - _GAP, _THINNEST * radius), length=length)
    disc = Cylinder(kind="cylinder", radius=radius, length=width)
    return [(core, 0.0), (disc, (length - width) / 2.0), (disc, (width - length) / 2.0)]
