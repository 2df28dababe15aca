"""Proofs that a ball cannot move to its goal among bodies at rest.

A ball that a moving body contains cannot go where the body cannot go. Positions are compared on a grid. A cell is
closed only if the ball overlaps a body wherever its centre is in the cell. Neighbouring cells share a face, an edge or
a corner. So if no open cells connect the start and the goal, there is no path. The converse is not true.

Functions of positions return margins that change at most as fast as the position. The goal is where a margin is not
negative.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.geometry.convex import ConvexBody
from hybrid_tamp.geometry.nearness import surely_within
from hybrid_tamp.motion.arrays import BoolArray, FloatArray

Margins = Callable[[FloatArray], FloatArray]
"""Function of positions ``(n, 3)`` [m] that returns margins ``(n,)`` [m]."""

_FINEST, _COARSEST = 0.01, 0.02
"""Smallest and usual edges of a cell [m]. The edge is a quarter of the ball's radius, within these bounds."""
_MOST_CELLS = 3e7
"""Largest number of cells. A larger room has larger cells."""
_BLOCK = 5
"""Number of cells along an edge of a block. Margins are first evaluated for blocks."""
_ROOM = 0.3
"""Room around all bodies, the start and the end [m]. No path needs to go farther out."""
_FARTHER = 1.0
"""Length by which a straight movement may end beyond its planned end [m]."""
_SUNK = 2e-3
"""Depth to which a body may sink into the floor [m]."""
_DIAGONAL = sqrt(3.0) / 2.0
"""Distance of the corners of a cell from its centre, as a fraction of the cell's edge."""
_BATCH = 20_000


@dataclass(frozen=True)
class Ball:
    """A ball that a moving body contains.

    Attributes:
        radius: radius [m].
        start: position of the centre at the start of the movement [m], shape ``(3,)``.
        end: position of the centre at the planned end of the movement [m], shape ``(3,)``.
    """

    radius: float
    start: FloatArray
    end: FloatArray


def is_cut_off(ball: Ball, bodies: Sequence[ConvexBody], admits: Margins, arrives: Margins) -> bool:
    """Return whether a ball certainly cannot move from its start to its goal.

    Args:
        ball: the ball.
        bodies: bodies at rest.
        admits: function that is not negative where the ball is allowed.
        arrives: function that is not negative in the goal. The goal must be less than `_ROOM` away from the bodies, the
            start and the end. If it may be farther away, nothing is proven.
    """
    from scipy import ndimage

    grid = _Grid.around(ball, bodies)
    closed = grid.find_closed(bodies, ball.radius)
    closed |= grid.spread(grid.evaluate(admits) < -_DIAGONAL * grid.edge * _BLOCK)
    start = grid.index(ball.start)
    if closed[start]:
        return False  # The grid cannot tell where the ball can go.
    labels, _ = ndimage.label(~closed, structure=np.ones((3, 3, 3)))
    reached = labels == labels[start]
    near = grid.evaluate(arrives) >= -_DIAGONAL * grid.edge * _BLOCK
    if _on_boundary(near):
        return False
    cells = grid.centres(np.argwhere(reached & grid.spread(near)))
    return not any((arrives(part) >= -_DIAGONAL * grid.edge).any() for part in _batches(cells))


def is_barred(
    balls: Sequence[Ball], bodies: Sequence[ConvexBody], direction: FloatArray, arrives: Margins, aside: float
) -> bool:
    """Return whether a straight movement certainly hits a body at rest before it reaches its goal.

    Args:
        balls: balls that the moving body contains, and that move with the body without turning around it.
        bodies: bodies at rest.
        direction: unit vector ``(3,)`` of the movement.
        arrives: function of the centre of the first ball that is not negative in the goal.
        aside: largest distance of the body from its straight way [m].
    """
    way, slack = way_to_goal(balls[0], direction, arrives, aside), aside + _FINEST / 2.0
    return any(surely_within(body, ball.start + way, ball.radius - slack).any() for ball in balls for body in bodies)


def way_to_goal(ball: Ball, direction: FloatArray, arrives: Margins, aside: float) -> FloatArray:
    """Return offsets ``(n, 3)`` [m] that a straight movement passes before it reaches its goal.

    There are none if the goal is farther away than the ways that are examined. See `is_barred` for the arguments.
    """
    way = np.arange(0.0, float(np.linalg.norm(ball.end - ball.start)) + _FARTHER, _FINEST)[:, None] * direction
    arrived = arrives(ball.start + way) >= -(aside + _FINEST / 2.0)
    return way[: int(np.argmax(arrived)) + 1] if arrived.any() else way[:0]


@dataclass(frozen=True)
class _Grid:
    """A grid of cubic cells.

    Attributes:
        lower: lower corner [m], shape ``(3,)``.
        edge: edge of a cell [m].
        blocks: number of blocks along each axis.
    """

    lower: FloatArray
    edge: float
    blocks: tuple[int, int, int]

    @classmethod
    def around(cls, ball: Ball, bodies: Sequence[ConvexBody]) -> "_Grid":
        """Return a grid around all bodies and both ends of the movement."""
        boxes = [_box(body) for body in bodies]
        corners = np.array([ball.start, ball.end, *(corner for box in boxes for corner in box)])
        lower, upper = corners.min(axis=0) - _ROOM, corners.max(axis=0) + _ROOM
        lower[2] = max(lower[2], -_BLOCK * _COARSEST)
        size = upper - lower
        usual = min(max(ball.radius / 4.0, _FINEST), _COARSEST)
        edge = max(usual, float(np.cbrt(size.prod() / _MOST_CELLS)))
        x, y, z = (int(count) for count in np.ceil(size / (edge * _BLOCK)))
        return cls(lower, edge, (x, y, z))

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of cells along each axis."""
        x, y, z = self.blocks
        return x * _BLOCK, y * _BLOCK, z * _BLOCK

    def index(self, position: FloatArray) -> tuple[int, int, int]:
        """Return the indices of the cell that contains a position ``(3,)`` [m]."""
        x, y, z = np.clip(((position - self.lower) / self.edge).astype(int), 0, np.array(self.shape) - 1)
        return int(x), int(y), int(z)

    def centres(self, indices: NDArray[np.int_], edge: float | None = None) -> FloatArray:
        """Return the centres ``(n, 3)`` [m] of cells from their indices ``(n, 3)``."""
        return self.lower + (indices + 0.5) * (edge or self.edge)

    def evaluate(self, margins: Margins) -> FloatArray:
        """Return the margins at the centres of all blocks, in the shape of `blocks`."""
        centres = self.centres(np.argwhere(np.ones(self.blocks, dtype=bool)), self.edge * _BLOCK)
        return np.concatenate([margins(part) for part in _batches(centres)]).reshape(self.blocks)

    def spread(self, blocks: BoolArray) -> BoolArray:
        """Return the values of the cells from the values of their blocks."""
        for axis in range(3):
            blocks = blocks.repeat(_BLOCK, axis=axis)
        return blocks

    def find_closed(self, bodies: Sequence[ConvexBody], radius: float) -> BoolArray:
        """Return the cells in which a ball of a radius [m] overlaps a body or the floor wherever its centre is."""
        closed = np.zeros(self.shape, dtype=bool)
        heights = self.lower[2] + self.edge * (np.arange(self.shape[2]) + 1.0)
        closed[:, :, heights < radius - _SUNK] = True
        for body in bodies:
            lower, upper = _box(body)
            first, last = self.index(lower - radius), self.index(upper + radius)
            part = tuple(slice(one, other + 1) for one, other in zip(first, last, strict=True))
            inside = np.argwhere(np.ones(closed[part].shape, dtype=bool)) + np.array(first)
            near = surely_within(body, self.centres(inside), radius - _DIAGONAL * self.edge)
            closed[part] |= near.reshape(closed[part].shape)
        return closed


def _box(body: ConvexBody) -> tuple[FloatArray, FloatArray]:
    """Return the lower and the upper corner of the box around a body [m], each ``(3,)``."""
    return -body.extents(-np.eye(3)), body.extents(np.eye(3))


def _on_boundary(cells: BoolArray) -> bool:
    """Return whether a cell at the boundary of a grid is true. The floor does not count as a boundary."""
    axes = range(cells.ndim)
    return any(cells.take([0, -1] if axis < 2 else [-1], axis=axis).any() for axis in axes)


def _batches(points: FloatArray) -> list[FloatArray]:
    return np.array_split(points, max(1, len(points) // _BATCH))
