"""Lower bounds of the distances between two bodies at many poses at once, without a library.

The gap between two convex solids along a unit vector is never larger than their distance, and if the solids overlap,
the largest gap is minus their depth. So the largest gap along several directions is a lower bound of the signed
distance. The directions are those of the separating axis theorem (Gottschalk, Lin and Manocha 1996), which are exact
for two boxes that overlap, and the directions of a few steps of Gilbert's algorithm (Gilbert 1966), which approach the
direction of the least distance.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.geometry.convex import ConvexBody, placed, reach_of
from hybrid_tamp.geometry.shapes import Shape
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import cross, quaternion_conjugate, rotate

FAR = 0.03
"""Distance above which the distance of a ball around one body from a box around the other one suffices [m]."""
_STEPS = 6
"""Number of steps of Gilbert's algorithm."""
_TINY = 1e-9
"""Length below which a vector has no direction [m]."""
_UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Poses:
    """Positions [m], shape ``(n, 3)``, and orientations as unit quaternions, shape ``(n, 4)``."""

    positions: FloatArray
    orientations: FloatArray

    def at(self, rows: NDArray[np.intp] | list[int]) -> "Poses":
        """Return the poses in some rows."""
        return Poses(self.positions[rows], self.orientations[rows])


def bound_distances(one: Shape, at: Poses, other: Shape, there: Poses) -> FloatArray:
    """Return lower bounds of the signed distances between two bodies [m], shape ``(n,)``.

    Near the other body, the bound is too low by a few per cent of the distance. Bounds above `FAR` may be much too low.

    Args:
        one: shape of a body.
        at: poses of this body.
        other: shape of another body.
        there: poses of the other body.
    """
    bounds = np.maximum(_outside(other, there, at.positions, one), _outside(one, at, there.positions, other))
    near = np.flatnonzero(bounds < FAR)
    if len(near):
        mine, theirs = list(_at(one, at.at(near))), list(_at(other, there.at(near)))
        bounds[near] = np.min([_bound(first, second) for first, second in product(mine, theirs)], axis=0)
    return np.asarray(bounds)


def _outside(shape: Shape, poses: Poses, points: FloatArray, ball: Shape) -> FloatArray:
    """Return the distances of the box around a body from the ball around a shape at points ``(n, 3)``, in metres."""
    lower, upper = _box(shape)
    local = rotate(quaternion_conjugate(poses.orientations), points - poses.positions)
    beyond = np.maximum(np.maximum(lower - local, local - upper), 0.0)
    return np.asarray(np.sqrt(np.einsum("nk,nk->n", beyond, beyond)) - _reach(ball))


@dataclass(frozen=True, eq=False)
class _Placed:
    """A convex solid at many poses. Its centres have shape ``(n, 3)``, and its axes, one per row, ``(n, 3, 3)``."""

    solid: ConvexBody
    centres: FloatArray
    axes: FloatArray

    @property
    def normals(self) -> FloatArray:
        """Directions, shape ``(n, m, 3)``, along which this solid may be separated from another one."""
        return self.axes if self.solid.points is not None or not self.solid.disc else self.axes[:, 2:]

    def beside(self, points: FloatArray) -> FloatArray:
        """Return the vectors ``(n, 3)`` from the nearest points of the solid, or of a hull's box, to points [m]."""
        local = np.einsum("nk,njk->nj", points - self.centres, self.axes)
        half = self.solid.half if self.solid.points is None else np.abs(self.solid.points).max(axis=0)
        beyond = local - np.clip(local, -half, half)
        if self.solid.disc:
            across = np.maximum(np.linalg.norm(beyond[:, :2], axis=1, keepdims=True), _TINY)
            beyond[:, :2] *= np.maximum(1.0 - self.solid.disc / across, 0.0)
        return np.asarray(np.einsum("nj,njk->nk", beyond, self.axes))

    def extents(self, directions: FloatArray) -> FloatArray:
        """Return how far the solid reaches from its centre along unit vectors ``(n, m, 3)`` [m], shape ``(n, m)``."""
        local = np.einsum("nmk,njk->nmj", directions, self.axes)
        return np.asarray(self.solid.extents(local.reshape(-1, 3)).reshape(directions.shape[:2]))

    def supports(self, directions: FloatArray) -> FloatArray:
        """Return the furthest points along vectors ``(n, 3)`` in the world frame [m], shape ``(n, 3)``."""
        local = self.solid.supports(np.einsum("nk,njk->nj", directions, self.axes))
        return np.asarray(self.centres + np.einsum("nj,njk->nk", local, self.axes))


@lru_cache(maxsize=256)
def _solids(shape: Shape) -> tuple[ConvexBody, ...]:
    return tuple(placed(shape, np.zeros(3), _UPRIGHT))


@lru_cache(maxsize=256)
def _reach(shape: Shape) -> float:
    return reach_of(shape)


@lru_cache(maxsize=256)
def _box(shape: Shape) -> tuple[FloatArray, FloatArray]:
    """Return the lower and the upper corner of the box around a shape in the body frame, each ``(3,)`` [m]."""
    upper = np.max([solid.extents(np.eye(3)) for solid in _solids(shape)], axis=0)
    lower = -np.max([solid.extents(-np.eye(3)) for solid in _solids(shape)], axis=0)
    return lower, upper


def _at(shape: Shape, poses: Poses) -> Iterator[_Placed]:
    for solid in _solids(shape):
        axes = rotate(poses.orientations[:, None], solid.axes)
        centres = poses.positions + rotate(poses.orientations, solid.position)
        yield _Placed(replace(solid, position=np.zeros(3), axes=np.eye(3)), centres, axes)


def _bound(one: _Placed, other: _Placed) -> FloatArray:
    """Return lower bounds of the signed distances of two convex solids [m], shape ``(n,)``."""
    between = other.centres - one.centres
    directions = _directions(one, other, between)
    gaps = np.einsum("nmk,nk->nm", directions, between) - one.extents(directions) - other.extents(-directions)
    best = gaps.max(axis=1)
    chosen = np.take_along_axis(directions, gaps.argmax(axis=1)[:, None, None], axis=1)[:, 0]
    nearest = other.supports(-chosen) - one.supports(chosen)
    for _ in range(_STEPS):
        lengths = np.linalg.norm(nearest, axis=1, keepdims=True)
        directed = nearest / np.maximum(lengths, _TINY)
        furthest = other.supports(-directed) - one.supports(directed)
        gap = np.einsum("nk,nk->n", directed, furthest)
        best = np.where(lengths[:, 0] > _TINY, np.maximum(best, gap), best)
        step = furthest - nearest
        share = -np.einsum("nk,nk->n", nearest, step) / np.maximum(np.einsum("nk,nk->n", step, step), _TINY**2)
        nearest = nearest + np.clip(share, 0.0, 1.0)[:, None] * step
    return np.asarray(best)


def _directions(one: _Placed, other: _Placed, between: FloatArray) -> FloatArray:
    """Return unit vectors ``(n, m, 3)`` that point from one solid to the other."""
    mine, theirs = one.normals, other.normals
    crossed = cross(mine[:, :, None], theirs[:, None]).reshape(len(between), -1, 3)
    beside = [one.beside(other.centres)[:, None], -other.beside(one.centres)[:, None]]
    vectors = np.concatenate([between[:, None], *beside, mine, theirs, crossed], axis=1)
    lengths = np.linalg.norm(vectors, axis=2, keepdims=True)
    # Parallel edges have no common perpendicular, and any other direction is a valid one.
    units = np.where(lengths > _TINY, vectors / np.maximum(lengths, _TINY), mine[:, :1])
    units = np.where(np.einsum("nmk,nk->nm", units, between)[..., None] < 0, -units, units)
    if one.solid.points is None and other.solid.points is None:
        return np.asarray(units)
    return np.concatenate([units, -units], axis=1)  # A hull may reach farther to one side of its centre.
