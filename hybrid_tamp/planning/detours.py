"""Paths around the bodies that a movement hits.

A path leads the token in the slot `Block.path` from the start to the end of its movement. All bodies that the instance
moves are carried along without turning. If the instance turns them, each orientation at some phases of the movement
must be free at every position, which excludes some paths that exist. If there is no room for the turn at an end of the
path, the bodies turn elsewhere (`turning_paths`). The forward models check the path afterwards.
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
from hybrid_tamp.planning.clearance import Neighbour, Sweep
from hybrid_tamp.planning.turning_paths import find_turning_path

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
    box = _box(obstacles, start, goal)

    def space_of(*carried: Carried) -> FreeSpace:
        return FreeSpace(carried, obstacles, admits, _MOST_CHECKS)

    first, last = ([_carried_at(track, lead, phase) for track in movement.tracks] for phase in (0.0, np.inf))
    turned = list(_turned(movement, lead))
    if turned:
        path = find_path(space_of(*first, *turned), start, goal, *box, seed)
        if path is None:
            ends = space_of(*first), space_of(*last)
            path = find_turning_path(space_of(*first, *turned), ends, start, goal, box, seed)
        if path is not None:
            return path
    return find_path(space_of(*first), start, goal, *box, seed)


def _carried_at(track: Track, lead: Track, phase: float) -> Carried:
    """Return a body as it moves with the leader at a phase of the movement, at most that of its end."""
    phase = min(phase, len(lead.positions) - 1.0)
    pose = track.at(phase)
    return Carried(track.body, pose.position - lead.at(phase).position, pose.orientation)


def _turned(movement: Sweep, lead: Track) -> Iterator[Carried]:
    """Yield the bodies that move with the leader, at later phases at which they have turned."""
    for track in movement.tracks:
        for phase in np.linspace(0.0, len(lead.positions) - 1.0, _PHASES).tolist()[1:]:
            carried = _carried_at(track, lead, phase)
            if not np.allclose(carried.orientation, track.orientations[0], atol=_TURNED):
                yield carried


def _obstacles(movement: Sweep, lead: Track) -> Iterator[Obstacle]:
    """Yield the bodies at rest. Near a body that is close to an end of the movement, the path may be as close."""
    others = {each.body.name: each for each in chain(*movement.neighbours)}
    for each in others.values():
        ends = [
            find_nearest(track.body, track.at(phase), each.body, each.pose).distance
            for track in movement.tracks
            for phase in (0.0, len(lead.positions) - 1.0)
        ]
        yield obstacle_near(each, min(ends))


def obstacle_near(each: Neighbour, distance: float) -> Obstacle:
    """Return a body at rest as an obstacle of a path, of which one end is at a distance from the body [m].

    A path that came nearer than `Neighbour.kept` would be refused, unless its end is as near.
    """
    margin = max(distance - _CLOSER, min(each.kept, distance - _ROUNDING))
    return Obstacle(each.body, each.pose, min(CLEARANCE, margin))


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
