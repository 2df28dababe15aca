"""Predicates of a controlled tumble: the edge does not slide, the box does not fall, and hands avoid the floor."""

import numpy as np

from hybrid_tamp.authoring import FloatArray, Parameter, Predicate, State, Token
from hybrid_tamp.skills import (
    POSE,
    StaticEndEffector,
    competence,
    heavy_enough,
    height_below,
    length_predicate,
    norm,
    one_by_one,
)

from .classes import Tumblable
from .edges import friction_left, room
from .metrics import CONTROLLED
from .tumbling_predicates import LOW_ENOUGH, STRONG_ENOUGH, WITHIN_REACH
from .turning_hands import axes_of_turn

_HAND = Parameter("hand", StaticEndEffector)
_OBJECT = Parameter("object", Tumblable)
_LEAST_WEIGHT = 0.1
"""Smallest weight [N] of a box that hands tumble. A lighter box follows the errors of the hands."""
_FASTEST = CONTROLLED["touchdown [rad/s]"][1]


def _grip(state: State, hand: Token, thing: Token) -> FloatArray:
    return np.asarray(max(friction_left(hand, thing, axis) for axis in axes_of_turn(state, hand, thing)))


def _size(state: State, hand: Token, thing: Token) -> FloatArray:
    return np.asarray(max(room(hand, thing, axis) for axis in axes_of_turn(state, hand, thing)))


def _slowness(state: State, thing: Token) -> FloatArray:
    return np.asarray(_FASTEST - norm(state[thing, "angular_velocity"]))


def _clearance(state: State, hand: Token) -> FloatArray:
    position = state[hand, "position"]
    return np.asarray(position[..., 2] - height_below(state, hand))


ROUGH_ENOUGH = competence(
    "rough_enough",
    (_HAND, _OBJECT),
    one_by_one(_grip),
    unit="1",
    scale=0.1,
    reads={"object": ("orientation",)},
    description="the friction of {object} is large enough for {hand} and a second hand to tumble it without slipping",
    denial="{object} is too smooth: its edge slides on the floor when {hand} and a second hand tumble it",
)
LARGE_ENOUGH = competence(
    "large_enough",
    (_HAND, _OBJECT),
    one_by_one(_size),
    reads={"object": ("orientation",)},
    description="{object} is large enough for {hand}, which fits between the floor and the leaning box",
    denial="{object} is too small for {hand}, which does not fit between the floor and the leaning box",
)
HEAVY_ENOUGH = heavy_enough(Tumblable, _LEAST_WEIGHT, "tumble", "throw it instead of tumbling it")
TURNS_SLOWLY = Predicate(
    "turns_slowly",
    (_OBJECT,),
    _slowness,
    unit="rad/s",
    scale=0.2,
    reads={"object": ("angular_velocity",)},
    description="{object} turns no faster than a controlled tumble allows",
    denial="{object} falls: it turns faster than a controlled tumble allows",
)
CLEAR_OF_FLOOR = length_predicate(
    "clear_of_floor",
    (_HAND,),
    _clearance,
    reads={"hand": POSE},
    description="{hand} is clear of the floor",
    denial="{hand} is pressed onto the floor",
)
ABLE_HAND = (STRONG_ENOUGH, ROUGH_ENOUGH, WITHIN_REACH, LOW_ENOUGH, LARGE_ENOUGH)
"""Feasibility facts of a tumble about each hand and the box."""
