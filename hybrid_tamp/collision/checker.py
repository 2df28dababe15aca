"""An independent check that the bodies of a plan or of a recording do not collide.

The check shares no code with the search for least distances, paths and meetings. It compares the poses of all bodies at
many instants: first the boxes around the bodies, and then, with the library python-fcl, the bodies without their
outermost layer. So it finds overlaps that are deeper than twice this layer. Contacts that a running block allows are no
collisions. Bodies that part after such a contact may touch until they are apart.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from hybrid_tamp.geometry.convex import ConvexBody, placed
from hybrid_tamp.geometry.meshes import Hull
from hybrid_tamp.geometry.shapes import solids_of
from hybrid_tamp.model.collision import Collision
from hybrid_tamp.model.contacts import ContactRules
from hybrid_tamp.model.grasp import pass_through
from hybrid_tamp.model.plan import BlockInstance
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import BoolArray, FloatArray
from hybrid_tamp.motion.poses import quaternion_conjugate, rotate

DEPTH = 2e-3
"""Least depth of an overlap that is found for certain [m]. Bodies in contact may sink in a little."""
_LAYER = DEPTH / 2.0
"""Thickness of the layer that each body loses [m]."""
_EVERY = 4
"""Number of states from one compared instant to the next one. States are control periods."""
_ORIGIN, _UPRIGHT = np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0])


def find_collisions(
    task: Task, instances: Sequence[BlockInstance], times: FloatArray, states: State
) -> tuple[Collision, ...]:
    """Return the first collision of each pair of bodies that collide.

    Args:
        task: task of the plan.
        instances: instances of the plan or of the recording, with their times.
        times: instants of the states [s], shape ``(t,)``.
        states: states of all tokens, batch shape ``(t,)``.
    """
    last = len(times) - 1
    rows = np.array([*range(0, last, _EVERY), last])
    times, states = times[rows], State(states.layout, states.values[rows])
    bodies = [_Body(token, states) for token in task.tokens if token.shape is not None]
    spans = list(_spans(instances, times))
    found = (_compare(task, one, other, spans, states) for one, other in combinations(bodies, 2))
    known = [(pair, row) for pair, row in found if row is not None]
    return tuple(_describe(pair, float(times[row]), instances) for pair, row in sorted(known, key=lambda each: each[1]))


@dataclass(frozen=True)
class _Span:
    """Rows of states from `first` to before `end`, in which the same instances run."""

    first: int
    end: int
    running: tuple[BlockInstance, ...]


def _spans(instances: Sequence[BlockInstance], times: FloatArray) -> Iterator[_Span]:
    instants = {each.start for each in instances} | {each.end for each in instances}
    bounds = sorted({0, len(times), *(int(row) for row in np.searchsorted(times, sorted(instants)))})
    for first, end in pairwise(bounds):
        now = float(times[first])
        yield _Span(first, end, tuple(each for each in instances if each.start <= now < each.end))


class _Body:
    """A body at the poses of all compared instants, with the boxes around it in the world frame."""

    def __init__(self, token: Token, states: State) -> None:
        self.token = token
        self.positions, self.orientations = states[token, "position"], states[token, "orientation"]
        self.moves = bool(np.ptp(self.positions, axis=0).any() or np.ptp(self.orientations, axis=0).any())
        self._solids: list[tuple[ConvexBody, Any]] = []
        rows = slice(None) if self.moves else slice(1)
        turned = quaternion_conjugate(self.orientations[rows])
        along = [rotate(turned, sign * axis) for sign in (1.0, -1.0) for axis in np.eye(3)]
        solids = placed(token.solid, _ORIGIN, _UPRIGHT)
        reached = [np.max([each.extents(directions) for each in solids], axis=0) for directions in along]
        self.upper = self.positions[rows] + np.stack(reached[:3], axis=1)
        self.lower = self.positions[rows] - np.stack(reached[3:], axis=1)

    def is_near(self, other: "_Body") -> BoolArray:
        """Return the instants at which the boxes around both bodies overlap by more than the layers, shape ``(t,)``."""
        over = np.minimum(self.upper, other.upper) - np.maximum(self.lower, other.lower)
        return np.broadcast_to((over > 2.0 * _LAYER).all(axis=1), len(self.positions))

    def at(self, row: int) -> list[Any]:
        """Return the solids of the body in python-fcl, at its pose in a row of the states."""
        import fcl

        if not self._solids:
            solid = self.token.solid
            pairs = zip(solids_of(solid), placed(solid, _ORIGIN, _UPRIGHT), strict=True)
            self._solids = [
                (place, fcl.CollisionObject(_geometry(part, place.shrunk(_LAYER)))) for part, place in pairs
            ]
        turn, position = self.orientations[row], self.positions[row]
        for place, thing in self._solids:
            axes = rotate(turn, place.axes)
            thing.setTransform(fcl.Transform(axes.T, position + rotate(turn, place.position)))
        return [thing for _, thing in self._solids]

    def overlaps(self, other: "_Body", row: int) -> bool:
        """Return whether the bodies without their layers overlap in a row of the states."""
        import fcl

        return any(fcl.collide(mine, theirs) for mine in self.at(row) for theirs in other.at(row))


def _geometry(part: Any, solid: ConvexBody) -> Any:
    import fcl

    if isinstance(part, Hull):
        faces = np.insert(part.triangles, 0, 3, axis=1).ravel()
        return fcl.Convex(solid.points, len(part.triangles), faces)
    if solid.ball:
        return fcl.Sphere(solid.ball)
    return fcl.Cylinder(solid.disc, 2.0 * solid.half[2]) if solid.disc else fcl.Box(*(2.0 * solid.half))


def _compare(
    task: Task, one: _Body, other: _Body, spans: Sequence[_Span], states: State
) -> tuple[tuple[str, str], int | None]:
    """Return the names of two bodies, and the first row in which they collide, or None."""
    names = one.token.name, other.token.name
    if not (one.moves or other.moves) or pass_through(one.token, other.token):
        return names, None
    near, parting, last = one.is_near(other), False, -1
    for span in spans:
        rules = ContactRules(task.domain.block_by_name, span.running, task.fixed_bodies, task.token_by_name)
        for row in (span.first + np.flatnonzero(near[span.first : span.end])).tolist():
            parting, last = parting and row == last + 1, row
            if rules.allow(*names, State(states.layout, states.values[row])):
                parting = True
            elif not one.overlaps(other, row):
                parting = False
            elif not parting:
                return names, row
    return names, None


def _describe(pair: tuple[str, str], time: float, instances: Sequence[BlockInstance]) -> Collision:
    running = [each for each in instances if each.start <= time <= each.end]
    holding = (next((each.name for each in running if name in each.slots.values()), "") for name in pair)
    one, other = holding
    return Collision(pair, (one, other), time)
