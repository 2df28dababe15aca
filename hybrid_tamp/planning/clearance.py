"""Collisions of a plan's movements with other bodies.

The movements are those of the forward models. The poses of a movement are compared with each body that is at rest
meanwhile, by bisection on distances (`collision.sweeps`). Contacts that the block allows are left out.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from hybrid_tamp.collision.bodies import Body, Nearest, Pose, bodies_of, bound_distance, find_nearest, pose_of
from hybrid_tamp.collision.sweeps import Clearance, Track, find_clearance
from hybrid_tamp.midlevel.predictions import Trace
from hybrid_tamp.model.contacts import ContactRules
from hybrid_tamp.model.control import CONTROL_PERIOD
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.grasp import pass_through
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.precedence import Precedence
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray

_EVERY = 8
"""Number of control steps between two poses of a track."""
_TOUCHING = 1e-3
"""Largest distance of bodies that touch at the start of a movement, e.g. a block and its table [m]."""
_DEEPER = 2e-3
"""Amount by which bodies that touch at the start of a movement may become deeper [m]."""


@dataclass(frozen=True)
class Neighbour:
    """A body at rest near a movement.

    Attributes:
        body: the body.
        pose: its pose.
        kept: distance that the movement must keep [m]. Movements to a target may end in contact.
    """

    body: Body
    pose: Pose
    kept: float = 0.0


@dataclass(frozen=True)
class Hit:
    """A movement that does not keep its distance from a body at rest.

    Attributes:
        nearest: the least distance of the movement from the body.
        kept: distance that the movement must keep [m].
    """

    nearest: Clearance
    kept: float

    @property
    def margin(self) -> float:
        """The least distance minus the distance to keep [m]."""
        return self.nearest.distance - self.kept


@dataclass(frozen=True)
class Sweep:
    """The movement of an instance in the forward models, and the bodies at rest that it must not hit.

    Attributes:
        instance: the instance.
        trace: states of the instance.
        tracks: tracks of the tokens that the instance moves.
        neighbours: for each track, the bodies at rest that the moving token must not hit.
        every: number of control steps between two poses of a track.
    """

    instance: BlockInstance
    trace: Trace
    tracks: tuple[Track, ...]
    neighbours: tuple[tuple[Neighbour, ...], ...]
    every: int = _EVERY

    def find_hit(self) -> Hit | None:
        """Return the neighbour to which the movement comes nearest, compared with the distance to keep, or None."""
        best: Hit | None = None
        for track, neighbours in zip(self.tracks, self.neighbours, strict=True):
            for each in neighbours:
                if track.bound_distance(each.body, each.pose) >= each.kept:
                    continue
                kept = require_distance(track, each)
                limit = kept + (0.0 if best is None else best.margin)
                found = find_clearance([track], [(each.body, each.pose)], limit=limit)
                best = best if found is None else Hit(found, kept)
        return best

    @property
    def times(self) -> FloatArray:
        """Times of the poses of the tracks from the start of the movement [s], shape ``(k,)``."""
        return np.array(_rows(self.trace.states, self.every)) * CONTROL_PERIOD

    def place_of(self, hit: Hit) -> tuple[float, float, float]:
        """Return the place of a collision, which is the middle between the nearest points of the bodies' cores [m]."""
        x, y, z = (float(each) for each in self.find_nearest_at(hit.nearest, hit.nearest.phase).points.mean(axis=0))
        return x, y, z

    def ends_near(self, hit: Hit) -> bool:
        """Return whether the two bodies of a collision are also too near to each other at the end of the movement."""
        return self.find_nearest_at(hit.nearest, np.inf).distance < hit.kept

    def find_nearest_at(self, nearest: Clearance, phase: float) -> Nearest:
        """Return the distance of the bodies of a least distance at a phase, or at the end of the movement."""
        index = next(i for i, track in enumerate(self.tracks) if track.body.name == nearest.moving)
        track = self.tracks[index]
        other = next(each for each in self.neighbours[index] if each.body.name == nearest.other)
        return find_nearest(track.body, track.at(min(phase, len(track.positions) - 1.0)), other.body, other.pose)


def find_sweeps(
    task: Task, plan: TaskPlan, traces: Mapping[str, Trace], deadline: Deadline = NEVER, every: int = _EVERY
) -> Iterator[Sweep]:
    """Yield the movements of a plan in the order of their starts.

    Args:
        task: task of the plan.
        plan: plan with a value for every hyperparameter.
        traces: maps each instance that moves tokens to its movement in the forward models.
        deadline: deadline of the command.
        every: number of states between two poses of a track.

    Raises:
        LimitReached: the deadline passes.
    """
    bodies, precedence = bodies_of(task), Precedence(task, plan)
    for instance in sorted(plan.instances, key=lambda i: (i.start, i.name)):
        if instance.name in traces:
            deadline.check()
            yield _find_sweep(task, plan, instance, traces[instance.name], bodies, precedence, every)


def _find_sweep(
    task: Task,
    plan: TaskPlan,
    instance: BlockInstance,
    trace: Trace,
    bodies: Mapping[str, Body],
    precedence: Precedence,
    every: int,
) -> Sweep:
    blocks = task.domain.block_by_name
    rules = ContactRules(blocks, [instance], task.fixed_bodies, task.token_by_name)
    moving = {
        token
        for other in plan.instances
        if other is not instance and precedence.may_overlap(other, instance)
        for slot, token in other.slots.items()
        if blocks[other.block].writes.get(slot)
    }
    resting = {name: body for name, body in bodies.items() if name not in moving | set(instance.slots.values())}
    tracks, neighbours = [], []
    for slot, name in instance.slots.items():
        if name in bodies and "position" in blocks[instance.block].writes.get(slot, ()):
            tracks.append(track_of(bodies[name], trace.states, every))
            mine = task.token_by_name[name]
            others = (
                other
                for other in resting
                if not rules.allow(name, other, trace.world) and not pass_through(mine, task.token_by_name[other])
            )
            neighbours.append(tuple(_neighbour(task, instance, bodies[other], trace.world) for other in others))
    return Sweep(instance, trace, tuple(tracks), tuple(neighbours), every)


def _neighbour(task: Task, instance: BlockInstance, body: Body, world: State) -> Neighbour:
    kept = 0.0 if body.name in instance.roles.values() else task.limits.clearance
    return Neighbour(body, pose_of(world, body.name), kept)


def track_of(body: Body, states: State, every: int = _EVERY) -> Track:
    """Return the track of a body through every n-th one of states with batch shape ``(t,)``, and through the last."""
    rows = _rows(states, every)
    return Track(body, states[body.name, "position"][rows], states[body.name, "orientation"][rows])


def _rows(states: State, every: int) -> list[int]:
    last = len(states.values) - 1
    return [*range(0, last, every), last]


def require_distance(track: Track, other: Neighbour) -> float:
    """Return the least distance that a moving body may have from a body at rest [m]."""
    return allow_contact(track.body, track.at(0.0), other.body, other.pose, other.kept)


def allow_contact(one: Body, at: Pose, other: Body, there: Pose, kept: float = 0.0) -> float:
    """Return the least distance that two bodies may have during a movement [m].

    Bodies that are near each other at the start may remain as near, and bodies that touch may remain as deep.

    Args:
        one: a body.
        at: pose of this body at the start of the movement.
        other: another body.
        there: pose of the other body at the start of the movement.
        kept: distance that the movement must keep from bodies that are farther away at the start [m].
    """
    if bound_distance(one, at, other, there) > max(_TOUCHING, kept + _DEEPER):
        return kept
    distance = find_nearest(one, at, other, there).distance
    if distance <= _TOUCHING:
        return min(distance, 0.0) - _DEEPER
    return min(kept, max(distance - _DEEPER, 0.0))
