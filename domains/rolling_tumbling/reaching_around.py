"""The blocks REACHING:beside and REACHING:away (paper, D5): a hand moves around a box to a face, or away from the box.

The hand's curve lies in the plane perpendicular to the axis of the hand at its face. A hand that can turn does so on
the way, and is parallel to the edge of the box when it arrives. The curve leaves the nearest face along a straight
line, passes the box on the side that is clear of the ground, and approaches the goal face along a straight line.
Another hand fits between the curve and the box. A one-dimensional motor primitive moves the hand along the curve.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hybrid_tamp.authoring import (
    DMP,
    Binding,
    Commands,
    Course,
    Duration,
    FloatArray,
    Hyperparameter,
    Hyperparameters,
    Parameters,
    Policy,
    State,
    Target,
    sample_times,
)
from hybrid_tamp.skills import (
    FREE_TO_MOVE,
    HORIZONTAL,
    Curve,
    ReachGoal,
    Reference,
    Timetable,
    Transit,
    TurnReference,
    advance,
    conditions,
    get_symbol,
    get_tokens,
    make_reaching,
    position_servo,
    profile_of,
    straight_profile,
    turn_along,
    turn_wrists,
)

from .classes import Tumblable
from .control_predicates import ABLE_HAND, CLEAR_OF_FLOOR, HEAVY_ENOUGH
from .curves import Route, curve_through
from .detours import off_the_face, route_away, route_to_face
from .faces import FACE, POSTURES
from .tumbling_geometry import above_ground, place_at
from .tumbling_predicates import ALIGNED, AT_FACE, CAN_WORK_AT, EXPOSED, ON_SIDE, POSTURE, WITHIN_REACH
from .turning_hands import ALIGNMENT

_SHORTEST = 0.8
_ASIDE = 0.02
"""Distance [m] of a hand's quick retreat from the face that it touches, which is less than the gap on the curve."""
_LETTING_GO = 0.1
"""Duration of the retreat [s]. The hand moves away faster than a box falls."""
_COMING_BACK = 0.5
_SPEED = Hyperparameter("speed", "m/s", 0.1, 0.8, lambda b, s: np.asarray(0.4), "mean speed along the curve")


def _curve(binding: Binding, start: State, path: FloatArray | None = None) -> Curve:
    """Return the curve around the box, or a curve with the same ends along a path ``(c, 3)`` [m]."""
    hand, thing = get_tokens(binding, "hand", "object")

    def make(state: State) -> Route:
        if "face" in binding:
            route = route_to_face(state, hand, thing, get_symbol(binding, "face"))
        else:
            route = route_away(state, hand, thing)
        return route if path is None else route.along(path)

    return curve_through(start, make)


def _end(binding: Binding, state: State) -> FloatArray:
    """Return the position ``(..., 3)`` [m] of the hand at the end of the curve."""
    return _curve(binding, state).points[..., -1, :]


def _orientation(binding: Binding, state: State) -> FloatArray:
    """Return the orientation ``(..., 4)`` of the hand at the end of the reach."""
    hand, thing = get_tokens(binding, "hand", "object")
    if "face" not in binding:
        return state[hand, "orientation"]
    return ALIGNMENT.orientation(state, hand, thing, get_symbol(binding, "face"))


def _place(binding: Binding, state: State) -> FloatArray:
    """Return the goal ``(..., 3)`` [m] at a face, or zero for mode ``away``, whose goal does not depend on the box."""
    if "face" not in binding:
        return np.zeros(3)
    hand, thing = get_tokens(binding, "hand", "object")
    return place_at(state, hand, thing, get_symbol(binding, "face"))


def _time(curve: Curve, hyperparameters: Hyperparameters) -> FloatArray:
    return np.asarray(np.maximum(curve.length / hyperparameters["speed"], _SHORTEST))


def _let_go(elapsed: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the distance [m] and the speed [m/s], each ``(..., 1)``, of the retreat that a hand adds to its curve.

    A curve begins slowly. Without the retreat, a box that leans on the hand would follow the hand and keep pressing on
    it until other hands take over.
    """
    off, leaving = advance(straight_profile(), elapsed, _LETTING_GO)
    back, returning = advance(straight_profile(), elapsed - _LETTING_GO, _COMING_BACK)
    return _ASIDE * (off - back)[..., None], _ASIDE * (leaving - returning)[..., None]


class _Plan(NamedTuple):
    """The movement of a hand around a box, or away from it.

    Attributes:
        reference: reference of the hand's position [m] and velocity [m/s], and the travelled share of the curve.
        turn: reference of the hand's orientation.
        duration: duration ``(...)`` [s].
        below: whether ``(..., 1)`` the hand starts beside a table, below its top. Then it rises along the curve.
    """

    reference: Reference
    turn: TurnReference
    duration: FloatArray
    below: NDArray[np.bool_]


def _plan(primitive: DMP | None, binding: Binding, start: State, parameters: Parameters) -> _Plan:
    (hand, thing), profile = get_tokens(binding, "hand", "object"), profile_of(primitive)
    curve = _curve(binding, start, parameters.path)
    duration = _time(curve, parameters.hyperparameters)
    outward = off_the_face(start, hand, thing)

    def reference(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        position, velocity = curve.at(elapsed, duration, profile)
        aside, speed = _let_go(elapsed)
        share = profile.share(elapsed / duration)[..., None]
        return position + outward * aside, velocity + outward * speed, share

    turn = turn_along(
        start[hand, "orientation"],
        _orientation(binding, start),
        lambda elapsed: curve.turned(elapsed, duration, profile),
    )
    return _Plan(reference, turn, duration, start[hand, "position"][..., 2:] < thing.ground.height)


def _sweep(primitive: DMP | None, binding: Binding, start: State, parameters: Parameters) -> Course:
    (hand, thing), plan = get_tokens(binding, "hand", "object"), _plan(primitive, binding, start, parameters)
    times = sample_times(plan.duration)
    position = plan.reference(times)[0]
    clear = np.where(plan.below, position, above_ground(hand, thing, position))
    moved = {(hand.name, "position"): clear, (hand.name, "orientation"): plan.turn(times)[0]}
    return Course.through(start, moved, times=times)


def _follow(primitive: DMP | None, binding: Binding, start: State, parameters: Parameters) -> Policy:
    (hand, thing), plan = get_tokens(binding, "hand", "object"), _plan(primitive, binding, start, parameters)
    planned, servo, timetable = _place(binding, start), position_servo(hand), Timetable(plan.reference, start)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        position, velocity, share = timetable(elapsed)
        # Other hands may still move the box, so the end of the curve follows the face.
        position = position + share * (_place(binding, state) - planned)
        # A hand that leaves a face which points down must not press on the ground.
        clear = np.where(plan.below, position, above_ground(hand, thing, position))
        velocity = np.where((clear > position).any(axis=-1, keepdims=True), velocity * HORIZONTAL, velocity)
        return {(hand.name, "force"): servo(state, clear, velocity)}

    return turn_wrists(policy, {hand: plan.turn})


REACH_BESIDE = make_reaching(
    ReachGoal(
        targets=(Target("object", Tumblable), Target("face", FACE), Target("posture", POSTURES)),
        position=_end,
        orientation=_orientation,
        entry=conditions((EXPOSED, POSTURE, ALIGNED, CAN_WORK_AT, *ABLE_HAND, HEAVY_ENOUGH, FREE_TO_MOVE)),
        preferences=conditions((ON_SIDE,)),
        arrived=conditions((AT_FACE,)),
        lasting=conditions((CLEAR_OF_FLOOR, POSTURE)),
        description="the hand moves around the box to a place at a face and stays there",
    ),
    "beside",
    transit=Transit(_follow, _sweep, _SPEED, Duration(0.3, 15.0)),
)
REACH_AWAY = make_reaching(
    ReachGoal(
        # The reach uses only the initial position of the box, so the box may move during the reach.
        targets=(Target("object", Tumblable, reads=()),),
        position=_end,
        orientation=_orientation,
        entry=(WITHIN_REACH("hand", "object"),),
        arrived=(),
        lasting=(CLEAR_OF_FLOOR("hand"),),
        description="the hand releases the box and moves far enough away for the box to be lowered",
    ),
    "away",
    transit=Transit(_follow, _sweep, _SPEED, Duration(_SHORTEST, 15.0)),
)
