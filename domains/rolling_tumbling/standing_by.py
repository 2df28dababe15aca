"""REACHING:beside and REACHING:away (paper, D5): a hand goes round a box to one of its faces, or away from it.

The curve lies in the plane across the hand's axis and goes round the box as a whole, with room for a hand in between:
straight off the face where the hand is, round the corners that keep off the floor, straight on to the face wanted.
A motor primitive in one dimension says how the hand goes along it.
"""

from functools import partial
from typing import cast

import numpy as np

from hybrid_tamp.authoring import (
    DMP,
    Binding,
    Block,
    Commands,
    Duration,
    FloatArray,
    Hyperparameter,
    Hyperparameters,
    Movement,
    Parameters,
    Policy,
    Profile,
    Slot,
    State,
    Target,
    Token,
)

from ..common.classes import StaticEndEffector
from ..common.predicates import AT_REST, REST_SPEED
from ..common.primitives import straight_profile
from ..common.servos import hand_system, position_servo
from .classes import Tumblable
from .detours import Curve, curve_away, curve_to_face, off_the_face
from .faces import FACE, POSTURES
from .predicates import IN_WORKSPACE
from .tumbling_geometry import place_at
from .tumbling_predicates import (
    ALIGNED,
    AT_FACE,
    EXPOSED,
    FACE_TOLERANCE,
    LOW_ENOUGH,
    ON_SIDE,
    POSTURE,
    STRONG_ENOUGH,
    WITHIN_REACH,
)

_SETTLING = 0.02
_SHORTEST = 0.8
_ASIDE = 0.02
"""How far a hand jumps off a face that it has touched [m]; less than the room that it keeps on its way."""
_LETTING_GO = 0.1
"""How long that takes [s]: the hand moves away faster than a box falls."""
_COMING_BACK = 0.5
_SPEED = Hyperparameter("speed", "m/s", 0.1, 0.8, lambda b, s: np.asarray(0.4), "mean speed along the curve")


def _curve(binding: Binding, start: State) -> Curve:
    hand, thing = cast(Token, binding["hand"]), cast(Token, binding["object"])
    if "face" in binding:
        return curve_to_face(start, hand, thing, cast(str, binding["face"]))
    return curve_away(start, hand, thing)


def _place(binding: Binding, state: State) -> FloatArray:
    """Return the place wanted ``(..., 3)`` [m]; zero for a hand that goes away, which heeds the box no more."""
    if "face" not in binding:
        return np.zeros(3)
    hand, thing = cast(Token, binding["hand"]), cast(Token, binding["object"])
    return place_at(state, hand, thing, cast(str, binding["face"]))


def _time(curve: Curve, hyperparameters: Hyperparameters) -> FloatArray:
    return np.asarray(np.maximum(curve.length / hyperparameters["speed"], _SHORTEST))


def _let_go(elapsed: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how far off its face ``(..., 1)`` [m] and how fast [m/s] a hand is, beyond what its curve says.

    A curve begins slowly, and a box that leans on a hand would follow it and press on it until others take it over.
    """
    off, back = elapsed / _LETTING_GO, (elapsed - _LETTING_GO) / _COMING_BACK
    profile = straight_profile()
    distance = profile.share(off) - profile.share(back)
    speed = profile.rate(off) / _LETTING_GO - profile.rate(back) / _COMING_BACK
    return _ASIDE * distance[..., None], _ASIDE * speed[..., None]


def _expected(binding: Binding, state: State, hyperparameters: Hyperparameters, profile: Profile) -> float:
    """The curve until the hand is near enough and slow enough."""
    curve = _curve(binding, state)
    near = FACE_TOLERANCE if "face" in binding else np.inf
    seconds = profile.arrival(curve.length, _time(curve, hyperparameters), near, REST_SPEED) + _SETTLING
    # Schedules count in milliseconds.
    return float(np.ceil(1e3 * seconds) / 1e3)


def _follow(binding: Binding, start: State, parameters: Parameters, profile: Profile) -> Policy:
    hand = cast(Token, binding["hand"])
    curve = _curve(binding, start)
    duration = _time(curve, parameters.hyperparameters)
    planned = _place(binding, start)
    outward = off_the_face(start, hand, cast(Token, binding["object"]))
    servo = position_servo(hand)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        position, velocity = curve.at(elapsed, duration, profile)
        aside, speed = _let_go(elapsed)
        position, velocity = position + outward * aside, velocity + outward * speed
        # Hands that hold the box may still be settling it: the end of the curve goes along with its face.
        share = profile.share(elapsed / duration)[..., None]
        position = position + share * (_place(binding, state) - planned)
        return {(hand.name, "force"): servo(state, position, velocity)}

    return policy


def _arrived(binding: Binding, state: State) -> State:
    """The hand is at the end of the curve."""
    return state.replace({(cast(Token, binding["hand"]).name, "position"): _curve(binding, state).points[..., -1, :]})


def reaching_beside(primitive: DMP | None = None) -> Block:
    """Return REACHING:beside; its primitive is the course along the curve, by default a straight movement."""
    profile = straight_profile() if primitive is None else Profile(primitive)
    return Block(
        name="REACHING:beside",
        slots=(Slot("hand", StaticEndEffector),),
        anchor="hand",
        targets=(Target("object", Tumblable), Target("face", FACE), Target("posture", POSTURES)),
        entry=(
            EXPOSED("face", "posture"),
            POSTURE("object", "posture"),
            ALIGNED("hand", "object", "face"),
            ON_SIDE("hand", "object", "face", "posture"),
            WITHIN_REACH("hand", "object"),
            STRONG_ENOUGH("hand", "object"),
            LOW_ENOUGH("hand", "object"),
        ),
        exit=(AT_FACE("hand", "object", "face"), AT_REST("hand")),
        writes={"hand": ("position", "velocity")},
        # The hands' workspace is not measured in the blocks of tumbling yet.
        keeps=(IN_WORKSPACE,),
        hyperparameters=(_SPEED,),
        duration=Duration(0.3, 15.0, partial(_expected, profile=profile)),
        hold=True,
        policy=partial(_follow, profile=profile),
        system=hand_system,
        taught=reaching_beside,
        movement=Movement("hand", "position", 1),
        outcome=_arrived,
        description="the hand goes round the box to its place at a face and holds there",
    )


def reaching_away(primitive: DMP | None = None) -> Block:
    """Return REACHING:away; its primitive is the course along the curve, by default a straight movement."""
    profile = straight_profile() if primitive is None else Profile(primitive)
    return Block(
        name="REACHING:away",
        slots=(Slot("hand", StaticEndEffector),),
        anchor="hand",
        # It reads where the box is only as it starts, so the box may move meanwhile.
        targets=(Target("object", Tumblable, reads=()),),
        entry=(WITHIN_REACH("hand", "object"),),
        exit=(AT_REST("hand"),),
        writes={"hand": ("position", "velocity")},
        # The hands' workspace is not measured in the blocks of tumbling yet.
        keeps=(IN_WORKSPACE,),
        hyperparameters=(_SPEED,),
        duration=Duration(_SHORTEST, 15.0, partial(_expected, profile=profile)),
        hold=True,
        policy=partial(_follow, profile=profile),
        system=hand_system,
        taught=reaching_away,
        movement=Movement("hand", "position", 1),
        outcome=_arrived,
        description="the hand lets go of the box and leaves it room to come down",
    )


REACH_BESIDE, REACH_AWAY = reaching_beside(), reaching_away()
