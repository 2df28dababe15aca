"""Bodies that certainly overlap, at one place and at all places of a set.

The depth of an overlap is the length of the shortest offset that separates two convex solids. So an offset that is
shorter than the depth does not separate them, and a set of offsets is examined in squares: each square is either
outside of the set, or at its middle the overlap is deeper than its half diagonal, or the square is divided.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from hybrid_tamp.collision.bodies import Body, Nearest, Pose, bound_distance, find_nearest
from hybrid_tamp.geometry.convex import placed
from hybrid_tamp.geometry.meshes import Hull
from hybrid_tamp.geometry.shapes import solids_of
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_from_rpy, quaternion_multiply

ERROR = 4e-3
"""Depth up to which an overlap is not certain [m]. It covers the errors of distances, and contact at the start."""
_WIDEST, _NARROWEST = 1.28, 0.01
"""Edges of the largest and of the smallest squares [m]."""

Placed = tuple[Body, Pose]
"""A convex solid and its pose."""
Margins = Callable[[FloatArray], FloatArray]
"""Function of offsets ``(n, 3)`` [m] that returns margins ``(n,)`` [m], which change at most as fast as the offset."""


@dataclass(frozen=True)
class Overlap:
    """The overlap of a moving body with a body at rest.

    Attributes:
        moving: name of the moving body.
        other: name of the body at rest.
        depth: depth in the pose [m].
        place: middle of the nearest points of both bodies [m].
    """

    moving: str
    other: str
    depth: float
    place: tuple[float, float, float]


@dataclass(frozen=True)
class Obstruction:
    """A body in a pose, and the bodies at rest that it must not overlap.

    Attributes:
        moving: name of the body.
        solids: convex solids of the body.
        others: maps the names of the bodies at rest to their convex solids.
        within: largest distance of any point of the body from its position in the pose [m].
    """

    moving: str
    solids: Sequence[Placed]
    others: Mapping[str, Sequence[Placed]]
    within: float

    def find(self, offset: FloatArray, at_least: float = 0.0) -> Overlap | None:
        """Return the deepest overlap at an offset ``(3,)`` [m], or None if no overlap is certain to be so deep [m]."""
        best: Overlap | None = None
        for name, solids in self.others.items():
            nearest = _deepest(self.solids, solids, offset)
            least = best.depth if best else at_least + self.within + ERROR
            if nearest is not None and -nearest.distance > least:
                x, y, z = (float(each) for each in nearest.points.mean(axis=0))
                best = Overlap(self.moving, name, -nearest.distance, (x, y, z))
        return best


def convex_solids(body: Body, pose: Pose) -> list[Placed]:
    """Return the convex solids of a body at a pose. Hulls are left out, because their depths are not certain."""
    return list(_split(body, pose))


def _split(body: Body, pose: Pose) -> Iterator[Placed]:
    for part, solid in zip(solids_of(body.shape), placed(body.shape, pose.position, pose.orientation), strict=True):
        if not isinstance(part, Hull):
            orientation = quaternion_multiply(pose.orientation, quaternion_from_rpy(part.rpy))
            yield Body(body.name, part), Pose(solid.position, orientation)


def _deepest(solids: Sequence[Placed], others: Sequence[Placed], offset: FloatArray) -> Nearest | None:
    found: Nearest | None = None
    for body, pose in solids:
        at = Pose(pose.position + offset, pose.orientation)
        for other, there in others:
            if bound_distance(body, at, other, there) < 0.0:
                nearest = find_nearest(body, at, other, there)
                found = nearest if found is None or nearest.distance < found.distance else found
    return found


def overlaps_everywhere(obstructions: Sequence[Obstruction], admits: Margins) -> bool:
    """Return whether, at each horizontal offset that is allowed, some body certainly overlaps a body at rest.

    Args:
        obstructions: the bodies. All of them have the same offset.
        admits: function of an offset that is not negative where the offset is allowed. If it allows offsets of more
            than half of `_WIDEST`, nothing is proven.
    """
    waiting = [(np.zeros(3), _WIDEST)]
    while waiting:
        middle, edge = waiting.pop()
        slack = edge / sqrt(2.0)
        if float(admits(middle[None])[0]) < -slack:
            continue
        inner = np.abs(middle).max() + edge / 2.0 < (_WIDEST - _NARROWEST) / 2.0
        if inner and any(each.find(middle, slack) for each in obstructions):
            continue
        if edge <= _NARROWEST:
            return False
        corners = np.array([(x, y, 0.0) for x in (-0.25, 0.25) for y in (-0.25, 0.25)])
        waiting.extend((middle + corner * edge, edge / 2.0) for corner in corners)
    return True
