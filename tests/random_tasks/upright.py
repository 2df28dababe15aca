"""Distances of simple bodies from upright boxes, for oracles.

No function here comes from the planner. All fixed bodies of the scenes are boxes that stand upright, or consist of such
boxes. A moving body consists of parts that keep their orientation: upright boxes, upright cylinders and balls.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.geometry.shapes import Box, Compound
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token

Floats = NDArray[np.float64]
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Part:
    """An upright box with horizontally rounded edges, or a ball.

    Attributes:
        centre: centre in the world, or relative to the position of the moving body [m], shape ``(3,)``.
        halves: half extents [m]. A cylinder and a ball have no horizontal extents.
        yaw: angle of the box about the vertical [rad].
        radius: radius by which the edges, or the ball, extend beyond the half extents [m].
        ball: whether the radius also extends the part vertically.
    """

    centre: Floats
    halves: tuple[float, float, float] = (0.0, 0.0, 0.0)
    yaw: float = 0.0
    radius: float = 0.0
    ball: bool = False

    @property
    def below(self) -> float:
        """Distance [m] of the lowest point below the position of the moving body."""
        return self.halves[2] + (self.radius if self.ball else 0.0) - float(self.centre[2])

    def moved(self, offset: Floats) -> "Part":
        """Return the part at another place."""
        return replace(self, centre=self.centre + offset)


def axes_of(yaw: float) -> Floats:
    """Return the horizontal axes of a box, one per row, shape ``(2, 2)``."""
    return np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])


def turned(yaw: float, offset: tuple[float, float, float]) -> Floats:
    """Return a vector that is turned about the vertical."""
    return np.array([*(np.array(offset[:2]) @ axes_of(yaw)), offset[2]])


def gap(wall: Part, part: Part, x: Floats, y: Floats, z: Floats) -> Floats:
    """Return a lower bound of the distance [m] between a wall and a part, negative if they overlap.

    The position of the moving body is given by arrays that broadcast with each other. The bound is exact for balls, and
    its sign is exact for all parts.
    """
    dx, dy = x + part.centre[0] - wall.centre[0], y + part.centre[1] - wall.centre[1]
    vertical = np.abs(z + part.centre[2] - wall.centre[2]) - wall.halves[2] - part.halves[2]
    own = axes_of(wall.yaw)
    if part.halves[0] == part.halves[1] == 0.0:
        beyond = [np.abs(dx * axis[0] + dy * axis[1]) - half for axis, half in zip(own, wall.halves, strict=False)]
        outside = np.hypot(np.maximum(beyond[0], 0.0), np.maximum(beyond[1], 0.0))
        level = outside + np.minimum(np.maximum(*beyond), 0.0)
        if part.ball:
            apart = np.hypot(np.maximum(level, 0.0), np.maximum(vertical, 0.0))
            return np.asarray(apart + np.minimum(np.maximum(level, vertical), 0.0) - part.radius)
        return np.asarray(np.maximum(level - part.radius, vertical))
    level = np.full(np.broadcast_shapes(dx.shape, dy.shape), -np.inf)
    for axis in (*own, *axes_of(part.yaw)):
        reach = sum(
            half * abs(float(side @ axis))
            for body in (wall, part)
            for half, side in zip(body.halves, axes_of(body.yaw), strict=False)
        )
        level = np.maximum(level, np.abs(dx * axis[0] + dy * axis[1]) - reach)
    return np.asarray(np.maximum(level - part.radius, vertical))


@dataclass(frozen=True)
class Room:
    """Fixed bodies above a floor.

    Attributes:
        walls: the boxes of which the fixed bodies consist.
    """

    walls: tuple[Part, ...]

    def gaps(self, body: tuple[Part, ...], x: Floats, y: Floats, z: Floats) -> Floats:
        """Return the least distance [m] of a body from walls and floor for each position."""
        found = np.min([z - part.below for part in body], axis=0) + 0.0 * (x + y)
        for wall in self.walls:
            for part in body:
                found = np.minimum(found, gap(wall, part, x, y, z))
        return np.asarray(found)

    def least(self, body: tuple[Part, ...], places: Floats) -> float:
        """Return the least distance [m] of a body from walls and floor over positions, shape ``(n, 3)``."""
        return float(self.gaps(body, *np.atleast_2d(places).T).min())

    def with_bodies(self, *bodies: Part) -> "Room":
        """Return the room with more bodies."""
        return Room((*self.walls, *bodies))


def parts_of(token: Token, task: Task) -> tuple[Part, ...]:
    """Return the upright boxes of which a body consists."""
    place, yaw = task.state[token, "position"], yaw_of(task.state[token, "orientation"])
    if isinstance(token.shape, Box):
        return (Part(place, token.shape.half_extents, yaw),)
    assert isinstance(token.shape, Compound)
    return tuple(
        Part(place + turned(yaw, part.position), part.half_extents, yaw)
        for part in token.shape.parts
        if part.kind == "box"
    )


def yaw_of(quaternion: Floats) -> float:
    """Return the angle about the vertical [rad] of an upright body, from its quaternion (x, y, z, w)."""
    return float(2.0 * np.arctan2(quaternion[2], quaternion[3]))


def axis_of(quaternion: Floats) -> Floats:
    """Return the direction of the body's z axis, from its quaternion (x, y, z, w), shape ``(3,)``."""
    x, y, z, w = quaternion
    return np.array([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)])


def rod(direction: Floats, radius: float, length: float) -> tuple[Part, ...]:
    """Return balls within a cylinder, i.e. its largest capsule."""
    reach = length / 2.0 - radius
    return tuple(Part(along * direction, radius=radius, ball=True) for along in np.linspace(-reach, reach, 5))


def post(radius: float, length: float) -> tuple[Part, ...]:
    """Return an upright cylinder."""
    return (Part(np.zeros(3), (0.0, 0.0, length / 2.0), radius=radius),)
