"""The block WITHDRAWING: a resting hand moves away along a path, so that other movements have room.

The block achieves nothing that a task planner needs. If a movement would hit a resting hand, the planner inserts an
instance before this movement, and chooses the path (`hybrid_tamp.planning.giving_way`).
"""

import numpy as np

from hybrid_tamp.model.block import Block, Duration, Slot
from hybrid_tamp.model.control import Commands, Parameters, Policy
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.skills.classes import StaticEndEffector
from hybrid_tamp.skills.paths import follow_path
from hybrid_tamp.skills.predicates import AT_REST, IN_WORKSPACE
from hybrid_tamp.skills.resting import stay
from hybrid_tamp.skills.roles import MOTION, get_token
from hybrid_tamp.skills.servos import hand_servo
from hybrid_tamp.skills.timetable import Timetable

_SHORTEST = np.asarray(0.8)
"""Shortest duration of the movement [s]."""


def _withdraw(binding: Binding, start: State, parameters: Parameters) -> Policy:
    """Return the policy of a hand that follows a path to its last corner. Without a path, the hand stays in place."""
    if parameters.path is None:
        return stay(binding, start, parameters, "hand")
    hand = get_token(binding, "hand")
    place = start[hand, "position"]
    goal = np.broadcast_to(parameters.path[-1], place.shape)
    timetable = Timetable(follow_path(place, parameters.path, goal, _SHORTEST).reference, start)
    servo = hand_servo(hand, start)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        return servo(state, *timetable(elapsed))

    return policy


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
    description="a resting hand moves away along a path, so that other movements have room",
)
GIVING_WAY = (("RESTING.token", "WITHDRAWING.hand"), ("WITHDRAWING.hand", "RESTING.token"))
"""Edges of the network by which a resting hand gives way."""
