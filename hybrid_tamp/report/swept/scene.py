"""What the views of a swept plan show: outlines of bodies, regions and swept areas in the coordinates of a view."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import ceil

import numpy as np

from hybrid_tamp.model.swept import SweptBody, SweptPath, SweptPlan
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.physics.pictures.outlines import disc_radius
from hybrid_tamp.report.swept.legend import DISTINCT
from hybrid_tamp.report.swept.outlines import Plane, bounds_of, disc, outline, swept_area

_AXES = "xyz"
_FLAT = 0.02
"""Largest change of height of a movement for which a view from above suffices [m]."""
_MOST_CHAPTERS = 6


@dataclass(frozen=True)
class Outlined:
    """A token in a view.

    Attributes:
        name: name of the token.
        kind: ``fixed``, ``movable`` or ``region``.
        outlines: outlines of its convex solids [m], each of shape ``(m, 2)``.
    """

    name: str
    kind: str
    outlines: list[FloatArray]


@dataclass(frozen=True, eq=False)
class Chapter:
    """Successive movements of a plan that are drawn together.

    Attributes:
        swept: all movements.
        first: index of the first movement.
        end: index behind the last movement.
    """

    swept: SweptPlan
    first: int
    end: int

    @property
    def paths(self) -> list[tuple[int, SweptPath]]:
        """The movements with their numbers in the plan, from 1."""
        return [(index + 1, self.swept.paths[index]) for index in range(self.first, self.end)]

    @cached_property
    def moved(self) -> dict[str, SweptBody]:
        """Maps each token that an earlier movement has moved to the last of these movements."""
        return {body.token: body for path in self.swept.paths[: self.first] for body in path.bodies}


@dataclass(frozen=True, eq=False)
class SweptView:
    """A view of some movements along an axis of the world frame.

    Attributes:
        chapter: the movements.
        plane: axes of the view.
    """

    chapter: Chapter
    plane: Plane

    @property
    def axis_names(self) -> tuple[str, str]:
        """Names of the axes to the right and upward."""
        return _AXES[self.plane[0]], _AXES[self.plane[1]]

    @property
    def shows_height(self) -> bool:
        """Whether the view is from the side."""
        return self.plane[1] == 2

    @cached_property
    def tokens(self) -> list[Outlined]:
        """The tokens where earlier movements have left them."""
        tokens = self.chapter.swept.task.tokens
        return [each for token in tokens if (each := self._outlined(token)) is not None]

    @cached_property
    def areas(self) -> list[list[FloatArray]]:
        """For each movement, outlines that cover the swept area."""
        return [
            [each for body in path.bodies for each in swept_area(self._token(body.token).solid, body, self.plane)]
            for _, path in self.chapter.paths
        ]

    @cached_property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The least and the greatest coordinates, each ``(2,)`` [m]."""
        shown = [each for token in self.tokens for each in token.outlines]
        lower, upper = bounds_of([*shown, *(each for area in self.areas for each in area)])
        return (np.minimum(lower, [np.inf, 0.0]) if self.shows_height else lower), upper

    def outlines_at(self, path: SweptPath, row: int, name: str | None = None) -> Iterator[FloatArray]:
        """Yield the outlines of the bodies of a movement in a row of their poses, or of one body with a name."""
        for body in path.bodies:
            if name in (None, body.token):
                shape = self._token(body.token).solid
                yield from outline(shape, body.positions[row], body.orientations[row], self.plane)

    def flatten(self, points: FloatArray) -> FloatArray:
        """Return points ``(..., 3)`` of the world frame in the coordinates of the view, shape ``(..., 2)``."""
        return np.asarray(points)[..., list(self.plane)]

    def _token(self, name: str) -> Token:
        return self.chapter.swept.task.token_by_name[name]

    def _outlined(self, token: Token) -> Outlined | None:
        state, moved = self.chapter.swept.task.state, self.chapter.moved.get(token.name)
        if (token.name, "position") not in state.layout.slices:
            return None
        position = state[token, "position"] if moved is None else moved.positions[-1]
        if token.shape is not None:
            orientation = state[token, "orientation"] if moved is None else moved.orientations[-1]
            kind = "fixed" if token.fixed_body else "movable"
            return Outlined(token.name, kind, outline(token.shape, position, orientation, self.plane))
        centre, radius = self.flatten(position), disc_radius(token)
        if self.shows_height:
            side = np.array([radius, 0.0])
            return Outlined(token.name, "region", [np.stack([centre - side, centre + side])])
        return Outlined(token.name, "region", [disc(centre, radius)])


def divide(swept: SweptPlan) -> list[Chapter]:
    """Return the movements in groups that are small enough for different colours, unless there are too many groups."""
    count = len(swept.paths)
    size = max(ceil(count / min(ceil(count / DISTINCT) or 1, _MOST_CHAPTERS)), 1)
    return [Chapter(swept, first, min(first + size, count)) for first in range(0, max(count, 1), size)]


def choose_planes(swept: SweptPlan) -> list[Plane]:
    """Return the view from above and, if heights change, the view from the side that shows the longer movements."""
    positions = [body.positions for path in swept.paths for body in path.bodies]
    if all(np.ptp(each[:, 2]) <= _FLAT for each in positions):
        return [(0, 1)]
    across = np.sum([np.abs(np.diff(each[:, :2], axis=0)).sum(axis=0) for each in positions], axis=0)
    return [(0, 1), (int(np.argmax(across)), 2)]
