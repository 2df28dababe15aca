"""What a body rests on: the floor, or the top of another body."""

from dataclasses import dataclass

import numpy as np

from hybrid_tamp.geometry.tops import Top
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.constants import FLOOR_FRICTION


@dataclass(frozen=True)
class Ground:
    """What a body rests on at the start of a task.

    Attributes:
        body: name of the body below, or empty for the floor.
        height: height of the surface on which the body rests [m].
        friction: friction coefficient of this surface.
        top: the level top of the body below. None for the floor, which has no edge, and for a top that is not level.
        fixed: whether nothing can move the body below.
    """

    body: str = ""
    height: float = 0.0
    friction: float = FLOOR_FRICTION
    top: Top | None = None
    fixed: bool = True

    @property
    def firm(self) -> bool:
        """Whether the surface is level, and nothing can move it."""
        return not self.body or (self.fixed and self.top is not None)

    @property
    def text(self) -> str:
        """The surface in words, e.g. ``the top of table``."""
        return f"the top of {self.body}" if self.body else "the floor"

    @property
    def edge(self) -> str:
        """The edge of the surface in words, e.g. ``the edge of table``."""
        return f"the edge of {self.body or 'the floor'}"

    def depth(self, points: FloatArray) -> FloatArray:
        """Return how deep points ``(..., 2)`` [m] lie within the edges of the surface, shape ``(...)`` [m]."""
        return np.full(points.shape[:-1], np.inf) if self.top is None else self.top.depth(points)


ON_FLOOR = Ground()
"""The floor, i.e. the plane z = 0."""
