"""The block WITHDRAWING: a resting hand moves away along a path, so that other movements have room.

The block achieves nothing that a task planner needs. If a movement would hit a resting hand, the planner inserts an
instance before this movement, and chooses the path (`hybrid_tamp.planning.giving_way`).
"""

import numpy as np

from hybrid_tamp.model.block import Block, Duration, Slot
from hybrid_tamp.model.control import Commands, Parameters, Policy
from hybrid_tamp.model.course import Course, sample_times
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.skills.classes import StaticEndEffector
from hybrid_tamp.skills.paths import Travel, follow_path
from hybrid_tamp.skills.predicates import AT_REST, IN_WORKSPACE
from hybrid_tamp.skills.resting import stay
from hybrid_tamp.skills.roles import MOTION, get_token
from hybrid_tamp.skills.servos import hand_servo
from hybrid_tamp.skills.timetable import Timetable

_SHORTEST = np.asarray(0.8)
"""Shortest duration of the movement [s]."""


def _travel(binding: Binding, start: State, path: FloatArray) -> Travel:
    """Return the movement to the last corner of a path ``(c, 3)`` [m]."""
    place = start[get_token(binding, "hand"), "position"]
    return follow_path(place, path, np.broadcast_to(path[-1], place.shape), _SHORTEST)


def _withdraw(binding: Binding, start: State, parameters: Parameters) -> Policy:
    """Return the policy of a hand that follows a path to its last corner. Without a path, the hand stays in place."""
    if parameters.path is None:
        return stay(binding, start, parameters, "hand")
    timetable = Timetable(_travel(binding, start, parameters.path).reference, start)
    servo = hand_servo(get_token(binding, "hand"), start)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        return servo(state, *timetable(elapsed))

    return policy


def _sweep(binding: Binding, start: State, parameters: Parameters) -> Course:
    if parameters.path is None:
        return Course(start.repeated(1))
    travel = _travel(binding, start, parameters.path)
    positions, _ = travel.reference(sample_times(travel.duration))
    return Course.through(start, {(get_token(binding, "hand").name, "position"): positions})


WITHDRAWING = Block(
    name="WITHDRAWING",
    slots=(Slot("hand", StaticEndEffector),),
    anchor="hand",
    exit=(AT_REST("hand"),),
    invariants=(IN_WORKSPACE("hand"),),
    writes={"hand": MOTION},
    duration=Duration(float(_SHORTEST), 15.0),
    hold=True,
    policy=_withdraw,
    path="hand",
    sweep=_sweep,
    description="a resting hand moves away along a path, so that other movements have room",
)
GIVING_WAY = (("RESTING.token", "WITHDRAWING.hand"), ("WITHDRAWING.hand", "RESTING.token"))
"""Edges of the network by which a resting hand gives way."""
