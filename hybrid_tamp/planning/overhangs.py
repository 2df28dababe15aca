"""Movements in which a body leaves the top of the table on which it rests."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.collision.sweeps import Track
from hybrid_tamp.geometry.shapes import Cylinder, Sphere
from hybrid_tamp.model.extents import corners_of
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import rotate
from hybrid_tamp.planning.clearance import Sweep

_ALONG = 0.02
"""Largest height above the table at which a body still moves along the table [m]."""
_LOWEST = 5e-3
"""Largest height of the points of a body on which it rests above its lowest point [m]."""
_TOLERANCE = 1e-3
"""Amount by which a body may reach farther beyond the edge than at the start of the movement [m]."""


@dataclass(frozen=True)
class Overhang:
    """A movement in which a body moves beyond the edge of the table on which it rests.

    Attributes:
        instance: name of the instance.
        thing: name of the body.
        table: name of the body below.
        beyond: distance of the resting body from the edge [m].
        place: position of the body [m], shape ``(3,)``.
    """

    instance: str
    thing: str
    table: str
    beyond: float
    place: FloatArray


def find_overhang(task: Task, movements: Iterable[Sweep], allowance: float = 0.0) -> Overhang | None:
    """Return the first movement in which a body moves along a table beyond the edge of the table, or None.

    A box must rest with all its points on the table. A round body must rest with the middle of its contact line.

    Args:
        task: task of the movements.
        movements: the movements.
        allowance: distance from the edge that a moving body must keep in addition [m].
    """
    for movement in movements:
        for track in movement.tracks:
            thing = task.token_by_name[track.body.name]
            # A domain with a class of tables decides itself where objects may go, e.g. over the edge into a tray.
            if thing.ground.top is None or thing.ground.body in task.fixed_bodies:
                continue
            depths = _depths(track, thing)
            bad = np.flatnonzero(depths < min(float(depths[0]), allowance) - _TOLERANCE)
            if len(bad):
                row = int(bad[0])
                place = track.positions[row]
                return Overhang(movement.instance.name, thing.name, thing.ground.body, -float(depths[row]), place)
    return None


def _depths(track: Track, thing: Token) -> FloatArray:
    """Return how deep a body rests within the edges of its table at each pose, shape ``(n,)`` [m].

    The depth is infinite for a movement that lifts the body.
    """
    if isinstance(thing.shape, Cylinder | Sphere):
        return thing.ground.depth(track.positions[:, :2])
    points = rotate(track.orientations[:, None], corners_of(thing.solid)) + track.positions[:, None]
    lowest = points[..., 2].min(axis=-1, keepdims=True)
    if np.any(lowest > thing.ground.height + _ALONG):
        return np.full(len(points), np.inf)
    resting = points[..., 2] <= lowest + _LOWEST
    return np.asarray(np.where(resting, thing.ground.depth(points[..., :2]), np.inf).min(axis=-1))
