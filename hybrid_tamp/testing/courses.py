"""Check of `Block.sweep`: rollouts with initial hyperparameters must stay near the declared course."""

import numpy as np

from hybrid_tamp.collision.bodies import Body
from hybrid_tamp.collision.deviations import Timing, find_deviation
from hybrid_tamp.collision.sweeps import Track
from hybrid_tamp.model.control import Parameters
from hybrid_tamp.model.course import SKEW
from hybrid_tamp.model.expectation import declared_course
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.testing.disagreement import Disagreements
from hybrid_tamp.testing.rollouts import Rollouts

_POSES = 60
"""Largest number of poses of a rollout that are compared."""


def check_courses(rolled: Rollouts, found: Disagreements) -> None:
    """Compare the poses in the rollout with initial hyperparameters with the course that the block declares.

    Args:
        rolled: rollouts of the block.
        found: collection to which disagreements are added.

    Raises:
        DomainError: the function fails, or its result has the wrong shape.
    """
    block = rolled.block
    if block.sweep is None or 0 not in rolled.rows:
        return
    chosen = {name: np.asarray(values[0]) for name, values in rolled.chosen.items()}
    course = declared_course(block, rolled.binding, rolled.start, Parameters(chosen))
    if course is None:
        return
    rows = rolled.sample(0, _POSES)
    passed = State(rolled.states.layout, rolled.states.values[rows, 0])
    timing = None if course.times is None else Timing(rows.astype(np.float64) * rolled.dt, course.times, SKEW)
    for slot in block.writes:
        token = rolled.binding[slot]
        assert isinstance(token, Token)
        if token.shape is None:
            continue
        body = Body(token.name, token.solid)
        deviation = find_deviation(_track(body, passed), _track(body, course.states), timing)
        if deviation > course.allowance:
            declared = f"{slot} stays within {1e3 * course.allowance:.0f} mm of its poses in the sweep"
            measured = f"in a rollout, {slot} is {1e3 * deviation:.1f} mm away from all poses of the sweep"
            found.add("sweep", block, rolled.binding, declared, measured, slot)


def _track(body: Body, states: State) -> Track:
    return Track(body, states[body.name, "position"], states[body.name, "orientation"])
