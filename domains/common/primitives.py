"""Motor primitives that blocks' reference trajectories are made of, learnt from demonstrations."""

from functools import cache
from importlib.resources import files

import numpy as np

from hybrid_tamp.motion.dmp import DMP
from hybrid_tamp.motion.minimum_jerk import minimum_jerk
from hybrid_tamp.motion.profile import Profile

_SAMPLES = 201


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
