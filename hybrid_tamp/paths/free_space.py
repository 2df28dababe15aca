"""The free space of bodies that move together without turning: positions at which they are clear of other bodies.

Between two positions, no point of a body moves farther than the distance of the positions. So a segment is free if the
sum of the slacks at its ends exceeds its length. Otherwise, the segment is divided (see `collision.sweeps`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hybrid_tamp.collision.bodies import Body, Pose, bound_distance, find_nearest
from hybrid_tamp.motion.arrays import FloatArray

_SHORTEST = 1e-3
"""Shortest segment that is divided [m]. A shorter segment that is not proven free counts as blocked."""


class OutOfChecks(Exception):
    """The largest number of distance checks is reached. The search catches this exception."""


@dataclass(frozen=True)
class Carried:
    """A body that moves with the reference point.

    Attributes:
        body: the body.
        offset: position of the body relative to the reference point [m], shape ``(3,)``.
        orientation: orientation of the body as a unit quaternion, shape ``(4,)``.
    """

    body: Body
    offset: FloatArray
    orientation: FloatArray

    def at(self, position: FloatArray) -> Pose:
        """Return the pose of the body if the reference point is at a position ``(3,)`` [m]."""
        return Pose(position + self.offset, self.orientation)


@dataclass(frozen=True)
class Obstacle:
    """A body at rest.

    Attributes:
        body: the body.
        pose: pose of the body.
        margin: smallest accepted distance from the moving bodies [m]. Negative if an overlap is accepted, e.g. with a
            body that touches the hand at the start.
    """

    body: Body
    pose: Pose
    margin: float


@dataclass
class Count:
    """A count of checked positions, which several free spaces may share.

    Attributes:
        most: largest number of checks.
        done: number of positions that were checked.
    """

    most: int
    done: int = 0


class FreeSpace:
    """The free space of bodies that move together without turning.

    Attributes:
        carried: the moving bodies.
        obstacles: the bodies at rest.
        admits: function of positions ``(..., 3)`` that returns the least margins ``(...)`` of further conditions [m].
    """

    def __init__(
        self,
        carried: Sequence[Carried],
        obstacles: Sequence[Obstacle],
        admits: Callable[[FloatArray], FloatArray],
        most: int | Count,
    ) -> None:
        """Create the free space.

        Args:
            carried: the moving bodies.
            obstacles: the bodies at rest.
            admits: function of positions ``(..., 3)`` that returns the least margins ``(...)`` of further conditions
                there [m], e.g. that the hand is in its workspace. A margin must not change faster than the position.
            most: largest number of checks, or a count that the space shares with other spaces.
        """
        self.carried, self.obstacles, self.admits = tuple(carried), tuple(obstacles), admits
        self._count = Count(most) if isinstance(most, int) else most

    @property
    def checks(self) -> int:
        """Number of positions that were checked."""
        return self._count.done

    def narrowed(self, margin: float) -> "FreeSpace":
        """Return the free space with margins of at most `margin` [m]. Both spaces count their checks together."""
        obstacles = [replace(each, margin=min(each.margin, margin)) for each in self.obstacles]
        return FreeSpace(self.carried, obstacles, self.admits, self._count)

    def slack(self, position: FloatArray) -> float:
        """Return a lower bound of how far the reference point at a position ``(3,)`` can move and stay free [m].

        The position is free if the slack is positive.

        Raises:
            OutOfChecks: the largest number of checks is reached.
        """
        if self._count.done >= self._count.most:
            raise OutOfChecks
        self._count.done += 1
        least = np.inf
        for carried in self.carried:
            pose = carried.at(position)
            for obstacle in self.obstacles:
                bound = bound_distance(carried.body, pose, obstacle.body, obstacle.pose) - obstacle.margin
                if bound < least:
                    nearest = find_nearest(carried.body, pose, obstacle.body, obstacle.pose)
                    least = min(least, nearest.distance - obstacle.margin)
        return min(least, float(self.admits(position))) if least > 0.0 else least

    def is_free(self, begin: FloatArray, end: FloatArray) -> bool:
        """Return whether the straight segment between two positions ``(3,)`` is free.

        Raises:
            OutOfChecks: the largest number of checks is reached.
        """
        waiting = [(begin, self.slack(begin), end, self.slack(end))]
        while waiting:
            one, near, other, far = waiting.pop()
            length = float(np.linalg.norm(other - one))
            if near <= 0.0 or far <= 0.0:
                return False
            if near + far > length:
                continue
            if length < _SHORTEST:
                return False
            middle = (one + other) / 2.0
            slack = self.slack(middle)
            waiting += [(middle, slack, other, far), (one, near, middle, slack)]
        return True
