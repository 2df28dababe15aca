"""The narrowest place on a way through free space, from a grid.

Random samples seldom hit a narrow gap. So a ball that the moving bodies contain is moved over a grid, along a way that
is short and far from bodies. The cell of this way with the least distance from a body is where the moving bodies have
to pass. A cell counts as open even if only a part of it is open, because a later search checks the bodies themselves.
"""

from collections.abc import Iterator
from itertools import product

import numpy as np

from hybrid_tamp.collision.bodies import Body
from hybrid_tamp.geometry.common_volume import face_planes
from hybrid_tamp.geometry.nearness import inner_radius
from hybrid_tamp.geometry.surfaces import hulls_of
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, rotate
from hybrid_tamp.paths.free_space import FreeSpace, Obstacle

_ROOM = 0.8
"""Room around start and goal that the grid covers [m]."""
_CELLS = 60_000
"""Approximate largest number of cells."""
_FAR = 0.3
"""Distance from a body above which cells do not differ [m]."""
_NEAR = 0.3
"""Distance from a body at which a cell costs twice as much as its length [m]. The way then meets gaps in the middle."""
_ALONG = 2
"""Number of cells on each side that determine the direction of a way."""
_HALF_NEIGHBOURS = [step for step in product((-1, 0, 1), repeat=3) if step > (0, 0, 0)]
"""Steps to one half of the 26 neighbours of a cell. The other half has the opposite steps."""


class Grid:
    """A grid of positions of the moving bodies around start and goal.

    Attributes:
        edge: edge of each cell [m].
        centres: centres of the cells ``(x, y, z, 3)`` [m].
        distances: distance of each centre from the nearest body ``(x, y, z)``, at most `_FAR` [m].
        open: whether a cell is open ``(x, y, z)``.
    """

    def __init__(
        self, space: FreeSpace, start: FloatArray, goal: FloatArray, lower: FloatArray, upper: FloatArray
    ) -> None:
        """Create the grid. The arguments are those of `search.find_path`."""
        low = np.maximum(np.minimum(start, goal) - _ROOM, lower)
        extent = np.minimum(np.maximum(start, goal) + _ROOM, upper) - low
        self.edge = float((np.prod(extent) / _CELLS) ** (1 / 3))
        axes = [np.arange(begin, begin + length, self.edge) for begin, length in zip(low, extent, strict=True)]
        self.centres = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        self.distances = np.full(self.centres.shape[:3], _FAR)
        for obstacle in space.obstacles:
            self._approach(obstacle)
        corner = self.edge * np.sqrt(0.75)
        """Distance of a corner of a cell from its centre [m]."""
        ball = max((inner_radius(each.body.shape) for each in space.carried if not np.any(each.offset)), default=0.0)
        # One layer at a time, because the margins are those of whole states.
        admitted = np.stack([space.admits(layer) for layer in self.centres]) + corner > 0.0
        self.open = (self.distances + corner > ball) & admitted

    def find_narrowest(self, start: FloatArray, goal: FloatArray) -> tuple[FloatArray, FloatArray] | None:
        """Return the centre of the narrowest cell on the best way, and the direction of the way there.

        The result is a position ``(3,)`` [m] and a unit vector ``(3,)``, or None if the grid has no way.
        """
        from scipy.sparse.csgraph import dijkstra

        begin, end = self._nearest_open(start), self._nearest_open(goal)
        numbers = np.flatnonzero(self.open)
        first, last = np.searchsorted(numbers, [begin, end])
        _, before = dijkstra(self._graph(), directed=False, indices=first, return_predecessors=True)
        way = [int(last)]
        while way[-1] != first:
            if before[way[-1]] < 0:
                return None
            way.append(int(before[way[-1]]))
        cells = numbers[way]
        centres = self.centres.reshape(-1, 3)[cells]
        aside = np.minimum(np.linalg.norm(centres - start, axis=-1), np.linalg.norm(centres - goal, axis=-1))
        inner = aside > 2.0 * self.edge
        if not inner.any():
            return None
        index = int(np.where(inner, self.distances.reshape(-1)[cells], np.inf).argmin())
        along = centres[min(index + _ALONG, len(centres) - 1)] - centres[max(index - _ALONG, 0)]
        return centres[index], along / float(np.linalg.norm(along))

    def close(self, place: FloatArray, radius: float) -> None:
        """Close all cells whose centres are within a radius [m] of a place ``(3,)`` [m]."""
        self.open &= np.linalg.norm(self.centres - place, axis=-1) > radius

    def _approach(self, obstacle: Obstacle) -> None:
        """Lower the distances near a body at rest. Beside edges, a distance may be a few percent too small."""
        near = np.linalg.norm(self.centres - obstacle.pose.position, axis=-1) < obstacle.body.reach + _FAR
        turned_back = quaternion_conjugate(obstacle.pose.orientation)
        local = rotate(turned_back, self.centres[near] - obstacle.pose.position)
        found = self.distances[near]
        for planes in _planes(obstacle.body):
            outside = np.full(len(local), -np.inf)
            for plane in planes:
                outside = np.maximum(outside, local @ plane[:3] + plane[3])
            found = np.minimum(found, outside)
        self.distances[near] = found

    def _nearest_open(self, place: FloatArray) -> int:
        """Return the flat index of the open cell nearest to a place."""
        away = np.where(self.open, np.linalg.norm(self.centres - place, axis=-1), np.inf)
        return int(away.argmin())

    def _graph(self) -> object:
        """Return the sparse matrix ``(n, n)`` of the costs of steps between the n open cells."""
        from scipy.sparse import coo_matrix

        number = np.full(self.open.shape, -1)
        count = int(self.open.sum())
        number[self.open] = np.arange(count)
        price = 1.0 + (_NEAR / np.maximum(self.distances, self.edge / 4.0)) ** 2
        ones, others, costs = [], [], []
        for step in _HALF_NEIGHBOURS:
            here, there = zip(*(_shifted(one) for one in step), strict=True)
            both = self.open[here] & self.open[there]
            ones.append(number[here][both])
            others.append(number[there][both])
            costs.append(self.edge * float(np.linalg.norm(step)) * (price[here][both] + price[there][both]) / 2.0)
        places = np.concatenate(ones), np.concatenate(others)
        return coo_matrix((np.concatenate(costs), places), shape=(count, count)).tocsr()


def _shifted(step: int) -> tuple[slice, slice]:
    """Return the slices of an axis that contain the cells before and after a step of -1, 0 or 1."""
    if step == 0:
        return slice(None), slice(None)
    front, back = slice(None, -1), slice(1, None)
    return (front, back) if step > 0 else (back, front)


def _planes(body: Body) -> Iterator[FloatArray]:
    """Yield planes ``(m, 4)`` that enclose each convex solid of a body: at its faces, and at some edges and corners."""
    steps = np.array([step for step in product((-1.0, 0.0, 1.0), repeat=3) if any(step)])
    slanted = steps / np.linalg.norm(steps, axis=-1, keepdims=True)
    for hull in hulls_of(body.shape):
        normals = np.concatenate([np.unique(face_planes(hull)[:, :3].round(9), axis=0), slanted])
        yield np.column_stack([normals, -(normals @ hull.vertices.T).max(axis=1)])
