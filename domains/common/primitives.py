"""Motor primitives that blocks' reference trajectories are made of, learnt from demonstrations."""

from collections.abc import Callable
from functools import cache
from importlib.resources import files

import numpy as np

from hybrid_tamp.authoring import DMP, FloatArray, Profile, minimum_jerk

_SAMPLES = 201
_AHEAD = 0.5
"""How far ahead the demonstrated reach goes, along its x axis [m]."""

Reference = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Elapsed time ``(...)`` [s] to position [m] and velocity [m/s], each ``(..., 3)``."""


@cache
def demonstrated_reach() -> DMP:
    """Return the curved reach in three dimensions, learnt from the demonstration that comes with the package."""
    with files(__package__).joinpath("reach.csv").open(encoding="utf-8") as lines:
        table = np.loadtxt(lines, delimiter=",", skiprows=1)
    return DMP.imitate(table[:, 0], table[:, 1:], n_weights=20)


@cache
def straight_movement() -> DMP:
    """Return the primitive in one dimension that goes from 0 to 1 as people's straight movements do.

    Its demonstration is the minimum-jerk profile (Flash and Hogan 1985), at rest at both ends.
    """
    time = np.linspace(0.0, 1.0, _SAMPLES)
    return DMP.imitate(time, minimum_jerk(time)[:, None], n_weights=20)


@cache
def straight_profile() -> Profile:
    """Return how `straight_movement` goes from its beginning to its end."""
    return Profile(straight_movement())


def reach_over(start: FloatArray, goal: FloatArray, duration: FloatArray) -> Reference:
    """Return the demonstrated reach, turned and stretched to lead from one place to another; its lift stays as it is.

    Args:
        start: where it begins, ``(..., 3)`` [m].
        goal: where it ends, ``(..., 3)`` [m].
        duration: how long it takes, ``(...)`` [s].
    """
    level, up = np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
    begin, way = start * level, (goal - start) * level
    movement = demonstrated_reach().trajectory(start * up, goal * up + _AHEAD * np.array([1.0, 0.0, 0.0]), duration)

    def at(elapsed: FloatArray) -> tuple[FloatArray, FloatArray]:
        position, velocity = (each[..., :1] / _AHEAD * way + each * up for each in movement.at(elapsed)[:2])
        return begin + position, velocity

    return at
