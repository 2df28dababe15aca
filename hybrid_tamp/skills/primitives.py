"""Motor primitives learnt from demonstrations, and reference trajectories that the primitives generate."""

from collections.abc import Callable
from functools import cache
from importlib.resources import files

import numpy as np

from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.motion.minimum_jerk import minimum_jerk
from hybrid_tamp.motion.profile import Profile
from hybrid_tamp.skills.vectors import HORIZONTAL, UP

_SAMPLES = 201
_AHEAD = 0.5
"""Displacement of the demonstrated reach along its x axis [m]."""

Reference = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Maps the elapsed time ``(...)`` [s] to a pair of (position [m], velocity [m/s]), each ``(..., 3)``."""


@cache
def demonstrated_reach() -> DMP:
    """Return the three-dimensional primitive of a curved reach, learnt from the demonstration in ``reach.csv``."""
    with files(__package__).joinpath("reach.csv").open(encoding="utf-8") as lines:
        table = np.loadtxt(lines, delimiter=",", skiprows=1)
    return DMP.imitate(table[:, 0], table[:, 1:], n_weights=20)


@cache
def straight_movement() -> DMP:
    """Return the one-dimensional primitive of a straight human movement from 0 to 1.

    The primitive is learnt from the minimum-jerk profile (Flash and Hogan 1985), which starts and ends at rest.
    """
    time = np.linspace(0.0, 1.0, _SAMPLES)
    return DMP.imitate(time, minimum_jerk(time)[:, None], n_weights=20)


@cache
def straight_profile() -> Profile:
    """Return the profile of `straight_movement`."""
    return Profile(straight_movement())


def profile_of(primitive: DMP | None) -> Profile:
    """Return the profile of a one-dimensional primitive. None stands for `straight_movement`."""
    return straight_profile() if primitive is None else Profile(primitive)


def advance(
    profile: Profile, elapsed: FloatArray, duration: FloatArray | float, amount: FloatArray | float = 1.0
) -> tuple[FloatArray, FloatArray]:
    """Return how far a movement along a profile has come, and how fast it is, each ``(...)``.

    Args:
        profile: profile of the movement.
        elapsed: time ``(...)`` [s] since the beginning of the movement, negative before the beginning.
        duration: duration ``(...)`` of the movement [s].
        amount: length ``(...)`` of the movement, e.g. in metres.
    """
    return profile.advance(elapsed, duration, amount)


def move_straight(origin: FloatArray, way: FloatArray, duration: float, begin: float = 0.0) -> Reference:
    """Return the reference of a straight movement from rest to rest.

    Args:
        origin: initial position ``(..., 3)`` [m].
        way: displacement ``(..., 3)`` [m] from the initial position to the final position.
        duration: duration of the movement [s].
        begin: elapsed time at which the movement begins [s].
    """
    profile = straight_profile()

    def at(elapsed: FloatArray) -> tuple[FloatArray, FloatArray]:
        done, speed = (each[..., None] for each in advance(profile, elapsed - begin, duration))
        return origin + done * way, speed * way

    return at


def reach_over(start: FloatArray, goal: FloatArray, duration: FloatArray) -> Reference:
    """Return the demonstrated reach, rotated about the vertical and scaled so that it leads from start to goal.

    Args:
        start: initial position ``(..., 3)`` [m].
        goal: final position ``(..., 3)`` [m].
        duration: duration of the reach ``(...)`` [s].
    """
    begin, way = start * HORIZONTAL, (goal - start) * HORIZONTAL
    movement = demonstrated_reach().trajectory(start * UP, goal * UP + _AHEAD * np.array([1.0, 0.0, 0.0]), duration)

    def at(elapsed: FloatArray) -> tuple[FloatArray, FloatArray]:
        position, velocity = (each[..., :1] / _AHEAD * way + each * UP for each in movement.at(elapsed)[:2])
        return begin + position, velocity

    return at
