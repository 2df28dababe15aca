"""Paths around the bodies that a movement hits.

A path leads the token in the slot `Block.path` from the start to the end of its movement. All bodies that the instance
moves are carried along without turning. If the instance turns them, each orientation at some phases of the movement
must be free at every position, which excludes some paths that exist. The forward models check the path afterwards.
"""

from collections.abc import Callable, Iterator
from itertools import chain

import numpy as np

from hybrid_tamp.collision.bodies import find_nearest
from hybrid_tamp.collision.sweeps import Track
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.paths.free_space import Carried, FreeSpace, Obstacle
from hybrid_tamp.paths.search import find_path
from hybrid_tamp.planning.clearance import Sweep

CLEARANCE = 0.02
"""Distance that a path keeps from other bodies [m], as an allowance for servo errors and rounded corners."""
_CLOSER = 2e-3
"""Amount by which a path may come closer to a body than the ends of the movement [m]."""
_ROUNDING = 1e-5
"""Largest rounding error of a distance [m]."""
_MOST_CHECKS = 20_000
"""Largest number of positions that a query checks."""
_ROOM = 0.6
"""Room around all bodies in which paths are sought [m]."""
_PHASES = 5
"""Number of phases at which the orientations of the moving bodies are compared."""
_TURNED = 1e-2
"""Largest difference of a component of two quaternions that count as equal."""


def find_detour(task: Task, movement: Sweep, seed: int) -> FloatArray | None:
    """Return the corners ``(c, 3)`` [m] of a path for a movement, or None if there is no path or none was found.

    Args:
        task: task of the plan.
        movement: movement that hits a body.
        seed: seed of the query.
    """
    block = task.domain.block_by_name[movement.instance.block]
    if block.path is None:
        return None
    leader = movement.instance.slots[block.path]
    lead = next(track for track in movement.tracks if track.body.name == leader)
    start, goal = lead.positions[0], lead.positions[-1]
    obstacles = list(_obstacles(movement, lead))
    admits = _admits(task, movement, leader)
    for carried in _carried(movement, lead):
        space = FreeSpace(carried, obstacles, admits, _MOST_CHECKS)
        path = find_path(space, start, goal, *_box(obstacles, start, goal), seed)
        if path is not None:
            return path
    return None


def _carried_at(track: Track, lead: Track, phase: float) -> Carried:
    """Return a body as it moves with the leader at a phase of the movement."""
    pose = track.at(phase)
    return Carried(track.body, pose.position - lead.at(phase).position, pose.orientation)


def _carried(movement: Sweep, lead: Track) -> Iterator[list[Carried]]:
    """Yield the bodies that move with the leader: first in all orientations of the movement, then in the first one."""
    phases = np.linspace(0.0, len(lead.positions) - 1.0, _PHASES).tolist()
    first = [_carried_at(track, lead, 0.0) for track in movement.tracks]
    turned = [
        each
        for track in movement.tracks
        for each in (_carried_at(track, lead, phase) for phase in phases[1:])
        if not np.allclose(each.orientation, track.orientations[0], atol=_TURNED)
    ]
    if turned:
        yield [*first, *turned]
    yield first


def _obstacles(movement: Sweep, lead: Track) -> Iterator[Obstacle]:
    """Yield the bodies at rest. Near a body that is close to an end of the movement, the path may be as close."""
    others = {each.body.name: each for each in chain(*movement.neighbours)}
    for each in others.values():
        ends = [
            find_nearest(track.body, track.at(phase), each.body, each.pose).distance
            for track in movement.tracks
            for phase in (0.0, len(lead.positions) - 1.0)
        ]
        # A path that came nearer than `Neighbour.kept` would be refused, unless its ends are as near.
        margin = max(min(ends) - _CLOSER, min(each.kept, min(ends) - _ROUNDING))
        yield Obstacle(each.body, each.pose, min(CLEARANCE, margin))


def _admits(task: Task, movement: Sweep, leader: str) -> Callable[[FloatArray], FloatArray]:
    """Return a function of positions ``(..., 3)`` of the leader.

    The function returns the least margins ``(...)`` of the invariants on lengths [m].
    """
    instance, world = movement.instance, movement.trace.world
    binding, moved = task.bind(instance.roles), [track.body.name for track in movement.tracks]
    literals = [
        each
        for each in task.domain.block_by_name[instance.block].invariants
        if each.predicate.unit == "m" and {instance.roles.get(role, role) for role in each.arguments} <= set(moved)
    ]
    offsets = {name: world[name, "position"] - world[leader, "position"] for name in moved}

    def admits(position: FloatArray) -> FloatArray:
        batch = position.shape[:-1]
        state = State(world.layout, np.broadcast_to(world.values, (*batch, world.values.shape[-1])))
        state = state.replace({(name, "position"): position + offset for name, offset in offsets.items()})
        margins = [each.margin(state, binding) for each in literals]
        return np.asarray(np.min(margins, axis=0) if margins else np.full(batch, np.inf))

    return admits


def _box(obstacles: list[Obstacle], start: FloatArray, goal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the corners, each ``(3,)`` [m], of a box with room around all bodies."""
    corners = [start, goal]
    for each in obstacles:
        corners += [each.pose.position - each.body.reach, each.pose.position + each.body.reach]
    return np.min(corners, axis=0) - _ROOM, np.max(corners, axis=0) + _ROOM
