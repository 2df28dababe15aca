"""Whether a drum can be rolled among fixed boxes, decided by samples and a flooded grid.

This oracle shares no code with the planner's comparison of movements: it has its own distances of points from boxes.
"""

import numpy as np

from hybrid_tamp.geometry.shapes import Box, Cylinder
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.poses import quaternion_conjugate, rotate

_CELL = 0.02
"""Edge of the cells of the grid [m]."""
_ROOM = 0.4
"""Room around everything [m]."""
_GAP = 0.005
"""Gap between a hand and the drum before a roll [m]."""


def find_obstruction(task: Task) -> str:
    """Return what makes the roll impossible, or an empty text.

    The task is one of `random_rolling` with obstacles. The drum rolls straight to the region, and the hand stays behind
    the drum. The hand is an upright cylinder. The grid is flooded with the sphere that the hand contains, so an empty
    text may be too optimistic.
    """
    hand, drum = task.token_by_name["hand"], task.token_by_name["cylinder"]
    assert isinstance(hand.shape, Cylinder)
    assert isinstance(drum.shape, Cylinder)
    start, end = task.state["cylinder", "position"], task.state["goal", "position"]
    way = (end - start) * np.array([1.0, 1.0, 0.0])
    length = float(np.linalg.norm(way))
    ahead = way / length
    rolled = np.linspace(0.0, 1.0, int(length / 0.005) + 2)[:, None] * way
    if _touches(task, _cylinder_points(drum.shape, task.state["cylinder", "orientation"]) + start, rolled):
        return "drum"
    behind = start - ahead * (drum.shape.radius + hand.shape.radius + _GAP)
    if _touches(task, _cylinder_points(hand.shape, np.array([0.0, 0.0, 0.0, 1.0])) + behind, rolled):
        return "hand behind the drum"
    connected = _flood(task, task.state["hand", "position"], behind, hand.shape.radius)
    return "" if connected else "way of the hand"


def _walls(task: Task) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Return position, orientation and half extents of each fixed box."""
    return [
        (task.state[token, "position"], task.state[token, "orientation"], np.array(token.shape.half_extents))
        for token in task.tokens
        if token.immovable and isinstance(token.shape, Box)
    ]


def _cylinder_points(shape: Cylinder, orientation: np.ndarray) -> np.ndarray:
    """Return points of a cylinder about 1 cm apart, shape ``(n, 3)`` [m]."""
    radii = np.linspace(0.0, shape.radius, int(shape.radius / 0.01) + 2)
    angles = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    heights = np.linspace(-shape.length / 2, shape.length / 2, int(shape.length / 0.01) + 2)
    r, a, h = np.meshgrid(radii, angles, heights, indexing="ij")
    points = np.stack([r * np.cos(a), r * np.sin(a), h], axis=-1).reshape(-1, 3)
    return rotate(orientation, np.unique(points.round(6), axis=0))


def _touches(task: Task, points: np.ndarray, moves: np.ndarray) -> bool:
    """Return whether points ``(n, 3)`` come into a wall during displacements ``(k, 3)``."""
    for place, turn, half in _walls(task):
        inverse = quaternion_conjugate(turn)
        mine, way = rotate(inverse, points - place), rotate(inverse, moves)
        if any((np.abs(mine + step) < half).all(axis=-1).any() for step in way):
            return True
    return False


def _flood(task: Task, start: np.ndarray, goal: np.ndarray, radius: float) -> bool:
    """Return whether a sphere can move from start to goal among the walls, on a grid above the floor."""
    from scipy import ndimage

    walls = _walls(task)
    reach = [(place - np.linalg.norm(half), place + np.linalg.norm(half)) for place, _, half in walls]
    corners = np.array([start, goal, *(corner for pair in reach for corner in pair)])
    lower, upper = corners.min(axis=0) - _ROOM, corners.max(axis=0) + _ROOM
    lower[2] = radius
    shape = np.ceil((upper - lower) / _CELL).astype(int) + 1
    axes = [low + _CELL * np.arange(count) for low, count in zip(lower, shape, strict=True)]
    cells = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    free = np.ones(cells.shape[:3], dtype=bool)
    for place, turn, half in walls:
        mine = np.abs(rotate(quaternion_conjugate(turn), cells - place))
        free &= np.linalg.norm(np.maximum(mine - half, 0.0), axis=-1) > radius
    labels, _ = ndimage.label(free, structure=np.ones((3, 3, 3)))
    one, other = (
        labels[tuple(np.clip(((p - lower) / _CELL).round().astype(int), 0, shape - 1))] for p in (start, goal)
    )
    return bool(one and one == other)
