"""Floods of a grid: whether a body that keeps its orientation can move from one place to others among walls."""

from collections.abc import Sequence

import numpy as np

from random_tasks.upright import Floats, Part, Room

CELL = 0.025
"""Edge of the cells of the grid [m]."""
_ROOM = 0.3
"""Room around all walls and places [m]."""
_NEAR = 1.5
"""Largest distance of a place from the cells that it may use, in cells."""


def flood(
    room: Room,
    body: tuple[Part, ...],
    start: Floats,
    goals: Sequence[Floats],
    limits: tuple[Floats, Floats],
    generous: bool = False,
) -> list[bool]:
    """Return for each goal whether the body can move there from its start.

    Args:
        room: the walls.
        body: parts of the moving body.
        start: position of the body at the start [m], shape ``(3,)``.
        goals: positions of the body [m], each of shape ``(3,)``.
        limits: smallest and largest coordinates of the position [m].
        generous: whether a cell is open if the body may be free anywhere in the cell. Then a goal that is not reached
            is certainly not connected. Otherwise, a cell is open if the body is free in its middle.
    """
    from scipy import ndimage

    axes = _axes(room, [start, *goals], limits)
    gaps = room.gaps(body, axes[0][:, None, None], axes[1][None, :, None], axes[2][None, None, :])
    least = -CELL * np.sqrt(3.0) / 2.0 if generous else 0.0
    joined = np.ones((3, 3, 3)) if generous else None
    labels, _ = ndimage.label(gaps > least, structure=joined)
    begun = _labels(labels, axes, start)
    return [bool(begun & _labels(labels, axes, goal)) for goal in goals]


def _axes(room: Room, places: Sequence[Floats], limits: tuple[Floats, Floats]) -> list[Floats]:
    """Return the coordinates of the cells along each axis [m]. Beyond them, nothing is in the way."""
    around = [
        (wall.centre + sign * np.array([reach, reach, wall.halves[2]]))
        for wall in room.walls
        for sign in (-1.0, 1.0)
        for reach in [float(np.hypot(*wall.halves[:2]))]
    ]
    corners = np.array([*places, *around])
    lower = np.maximum(corners.min(axis=0) - _ROOM, limits[0])
    upper = np.minimum(corners.max(axis=0) + _ROOM, limits[1])
    return [
        low + CELL * np.arange(max(1, int((high - low) / CELL) + 1)) for low, high in zip(lower, upper, strict=True)
    ]


def _labels(labels: np.ndarray, axes: list[Floats], place: Floats) -> set[int]:
    """Return the labels of the open cells near a place."""
    near = np.ix_(
        *(np.flatnonzero(np.abs(axis - value) <= _NEAR * CELL) for axis, value in zip(axes, place, strict=True))
    )
    return {int(label) for label in np.unique(labels[near])} - {0}
