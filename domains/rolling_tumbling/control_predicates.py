"""Predicates of a controlled tumble: the edge does not slide, the box does not fall, and hands avoid the floor."""

import numpy as np

from hybrid_tamp.authoring import GRAVITY, FloatArray, Parameter, Predicate, State, Token
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
from .metrics import CONTROLLED
from .sliding import friction_needed, leaning_friction
from .tumbling_geometry import GRIP, room_below, sections
from .tumbling_predicates import LOW_ENOUGH, STRONG_ENOUGH, WITHIN_REACH, strength_needed
from .turning_hands import axes_of_turn

_HAND = Parameter("hand", StaticEndEffector)
_OBJECT = Parameter("object", Tumblable)
_LEAST_WEIGHT = 0.1
"""Smallest weight [N] of a box that hands tumble. A lighter box follows the errors of the hands."""
_FASTEST = CONTROLLED["touchdown [rad/s]"][1]


def _grip(state: State, hand: Token, thing: Token) -> FloatArray:
    """Return the friction of a box minus the friction needed, for the axis of the turn that needs the least friction.

    The box lies on its longer side or leans on a hand. If the hand is too weak even for a rough box, STRONG_ENOUGH
    states this reason, and friction is not to blame.
    """
    return np.asarray(
        thing["friction"] - min(_friction(hand, thing, axis) for axis in axes_of_turn(state, hand, thing))
    )


def _friction(hand: Token, thing: Token, axis: int) -> float:
    """Return the friction that a hand needs to turn a box about a body axis."""
    short, long = sorted(sections(thing, axis))
    force = max(float(hand["maximal_force"]), strength_needed(thing, axis))
    turning = friction_needed(GRAVITY * thing["mass"], long, GRIP * short, force)
    return float(max(turning, leaning_friction(short, long), leaning_friction(long, short)))


def _size(state: State, hand: Token, thing: Token) -> FloatArray:
    """Return the room [m] for the hand below a box that leans over either of its sides, for the best axis."""
    return np.asarray(max(_room(hand, thing, axis) for axis in axes_of_turn(state, hand, thing)))


def _room(hand: Token, thing: Token, axis: int) -> float:
    """Return the smaller room [m] for the hand below a box that turns about a body axis."""
    one, other = sections(thing, axis)
    return min(room_below(hand, one, other), room_below(hand, other, one))


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
