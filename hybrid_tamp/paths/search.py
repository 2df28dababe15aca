"""Paths through free space by sampling: RRT-Connect (Kuffner and LaValle 2000) of the library OMPL.

If a short search finds no path, the path leads through the narrowest place on the way (`narrow`), and if this fails,
too, a long search follows. A query counts the checked positions and never reads a clock. Each query has its own seed.
So equal queries have equal paths, whatever the load of the computer. A search that finds no path proves nothing.
"""

from typing import Any

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.paths.free_space import FreeSpace, OutOfChecks
from hybrid_tamp.paths.grid import Grid
from hybrid_tamp.paths.narrow import find_widest, refine_corners

_RANGE = 0.5
"""Longest segment of the search trees [m]."""
_REDUCTIONS = 30
_SHORTCUTS = 60
"""Numbers of steps in which a path is shortened."""
_SHORT = 2_000
"""Number of checks after which a short search ends."""
_GAPS = 3
"""Largest number of narrow places that are tried."""
_CLEAR = 1e-3
"""Slack from which a position counts as clear of all bodies [m]."""
_STEPS = (0.03, 0.01)
"""Lengths of the steps away from a body that are tried [m]."""
_QUESTIONS = 20_000
"""Largest number of iterations of the search, because an iteration need not check a position."""


def find_path(
    space: FreeSpace, start: FloatArray, goal: FloatArray, lower: FloatArray, upper: FloatArray, seed: int
) -> FloatArray | None:
    """Return the corners ``(c, 3)`` [m] of a free path from start to goal, or None if the search finds no path.

    Args:
        space: the free space.
        start: position ``(3,)`` [m] at which the path begins.
        goal: position ``(3,)`` [m] at which the path ends.
        lower: lower corner ``(3,)`` of the box that contains all samples [m].
        upper: upper corner ``(3,)`` of the box [m].
        seed: seed of the query.
    """
    try:
        if min(space.slack(start), space.slack(goal)) <= 0.0:
            return None
        if space.is_free(start, goal):
            return np.array([start, goal])
        box = np.array([lower, upper])
        ends = _step_away(space, start), _step_away(space, goal)
        path = _search(space, *ends, box, seed, _SHORT)
        if path is None:
            path = _search_through_gap(space, *ends, box, seed)
        path = _search(space, *ends, box, seed) if path is None else path
    except OutOfChecks:
        return None
    return None if path is None else _join(start, path, goal)


def _step_away(space: FreeSpace, position: FloatArray) -> FloatArray:
    """Return the end of a free step away from the nearest body, or the position itself if it is clear of all bodies.

    From a position in contact, only segments nearly along the normal of the contact are proven free. Random samples
    hardly ever lie in this direction.
    """
    if space.slack(position) > _CLEAR:
        return position
    offsets = _CLEAR * np.eye(3)
    slope = np.array([space.slack(position + each) - space.slack(position - each) for each in offsets])
    for step in _STEPS if slope.any() else ():
        away = position + step * slope / np.linalg.norm(slope)
        if space.is_free(position, away):
            return np.asarray(away)
    return position


def _join(start: FloatArray, path: FloatArray, goal: FloatArray) -> FloatArray:
    """Return the corners of a path with its ends, unless the path has these ends."""
    first = [] if np.array_equal(start, path[0]) else [start]
    last = [] if np.array_equal(goal, path[-1]) else [goal]
    return np.array([*first, *path, *last])


def _search_through_gap(
    space: FreeSpace, start: FloatArray, goal: FloatArray, box: FloatArray, seed: int
) -> FloatArray | None:
    """Return the corners of a path through the narrowest place on the way, or None."""
    grid = Grid(space, start, goal, *box)
    for _ in range(_GAPS):
        found = grid.find_narrowest(start, goal)
        if found is None:
            return None
        cell, direction = found
        place, tight = find_widest(space, cell, direction)
        if tight is not None:
            halves = [_search(tight, *ends, box, seed, _SHORT) for ends in ((start, place), (place, goal))]
            if halves[0] is not None and halves[1] is not None:
                return refine_corners(tight, np.concatenate([halves[0], halves[1][1:]]))
        grid.close(cell, 2.0 * grid.edge)
    return None


def _search(
    space: FreeSpace, start: FloatArray, goal: FloatArray, box: FloatArray, seed: int, most: float = np.inf
) -> FloatArray | None:
    """Return the corners of a path, or None if the search finds no path within `most` checks."""
    if space.is_free(start, goal):
        return np.array([start, goal])
    from ompl import base, geometric, util

    util.setLogLevel(util.LogLevel.LOG_NONE)
    # The seed must be set before any object of the query exists. Zero would stand for a random seed.
    util.RNG.setSeed(seed % (2**31 - 1) + 1)
    real = base.RealVectorStateSpace(3)
    bounds = base.RealVectorBounds(3)
    for axis, (low, high) in enumerate(box.T):
        bounds.setLow(axis, float(low))
        bounds.setHigh(axis, float(high))
    real.setBounds(bounds)
    setup = geometric.SimpleSetup(real)
    information = setup.getSpaceInformation()
    setup.setStateValidityChecker(lambda state: bool(space.slack(_position(state)) > 0.0))
    information.setMotionValidator(_make_validator(information, space))
    setup.setStartAndGoalStates(_state(real, start), _state(real, goal))
    planner = geometric.RRTConnect(information)
    planner.setRange(_RANGE)
    setup.setPlanner(planner)
    asked, last = iter(range(_QUESTIONS)), space.checks + most
    stop = base.PlannerTerminationCondition(lambda: next(asked, None) is None or space.checks >= last)
    setup.solve(stop)
    if not setup.haveExactSolutionPath():
        return None
    path = setup.getSolutionPath()
    simplifier = geometric.PathSimplifier(information)
    simplifier.reduceVertices(path, _REDUCTIONS, _REDUCTIONS)
    simplifier.partialShortcutPath(path, _SHORTCUTS, _SHORTCUTS)
    simplifier.reduceVertices(path, _REDUCTIONS, _REDUCTIONS)
    corners = np.array([_position(path.getState(index)) for index in range(path.getStateCount())])
    corners[0], corners[-1] = start, goal
    return corners


def _position(state: Any) -> FloatArray:
    return np.array([state[0], state[1], state[2]])


def _state(real: Any, position: FloatArray) -> Any:
    state = real.allocState()
    for axis, value in enumerate(position):
        state[axis] = float(value)
    return state


def _make_validator(information: Any, space: FreeSpace) -> Any:
    """Return the motion validator that checks segments by bisection on distances, without samples."""
    from ompl import base

    class Validator(base.MotionValidator):  # type: ignore[misc]  # OMPL has no type information
        def checkMotion(self, one: Any, other: Any, last: Any = None) -> bool:  # noqa: N802 the name is OMPL's
            return space.is_free(_position(one), _position(other))

    return Validator(information)
