"""The blocks LIFTING, HOLDING and LOWERING (paper, Sec. II-E), for hands on opposite sides of a box.

Each block has two modes: ``two``, with one hand on each side, and ``four``, with two hands on each side. Four hands,
which may belong to two robots, can lift a box that is too heavy for two hands. The box is not attached to any hand.
LIFTING and LOWERING end by themselves. In HOLDING, the hands keep the box in the air until LOWERING begins.
"""

from collections.abc import Callable
from functools import partial
from itertools import chain
from typing import Any

import numpy as np

from hybrid_tamp.authoring import (
    DMP,
    Binding,
    Block,
    Duration,
    FloatArray,
    Hyperparameter,
    Literal,
    Movement,
    Parameters,
    Policy,
    Predicate,
    Profile,
    State,
)
from hybrid_tamp.skills import (
    STANDBY_GAP,
    advance,
    conditions,
    gaps_to_faces,
    make_pressing,
    profile_of,
    squeezing,
    straight_profile,
)

from .bearing import bear, bearing_system
from .classes import Liftable
from .load import largest_squeeze, squeeze_for
from .places import FLOOR_TOLERANCE, Roles, height, places_of
from .predicates import (
    AT_PLACE,
    CLEAR_OF,
    LOWEST_LIFT,
    OF_BOX,
    OF_HAND,
    RAISED,
    STANDS,
    WITHIN_REACH,
    room_above,
)

MODES = {"two": "two hands", "four": "four hands"}
"""Maps each mode to its crew."""
_CLOSING = 0.3
"""Time in which hands close on a box or move away from a box [s]."""
GRASPED = 0.5
"""Time from the start of LIFTING until the hands squeeze the box fully and bear its weight [s]."""
_USUAL, _HIGHEST = 0.15, 0.3
"""Height of a lift by default, and its largest height [m]."""
_SPEED = Hyperparameter("speed", "m/s", 0.03, 0.2, lambda b, s: np.asarray(0.1), "mean vertical speed")


def usual_height(crew: str, binding: Binding, state: State) -> FloatArray:
    """Return the default height ``(...)`` [m] of a lift, or a lower height if a hand would leave its workspace."""
    roles = Roles.of(crew, binding)
    room = np.min([room_above(state, hand, roles.thing, place) for hand, place in roles.hands], axis=0)
    return np.asarray(np.clip(room, LOWEST_LIFT, _USUAL))


def _squeezes(crew: str, binding: Binding) -> tuple[float, float, float]:
    """Return the limits of the squeeze [N]. The largest squeeze leaves the hands enough force to bear the box."""
    roles = Roles.of(crew, binding)
    largest = min(largest_squeeze(hand, roles.thing, crew) for hand, _ in roles.hands)
    return 0.0, squeeze_for(roles.thing, crew), largest


def _lift(crew: str, profile: Profile, binding: Binding, start: State, parameters: Parameters) -> Policy:
    roles, straight = Roles.of(crew, binding), straight_profile()
    speed, rise = (np.asarray(parameters.hyperparameters[name]) for name in ("speed", "height"))

    def course(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        grip = straight.share(elapsed / GRASPED)
        # Before contact, a hand that compensated its share of the weight would rise.
        loaded = straight.share((elapsed - _CLOSING) / (GRASPED - _CLOSING))
        closed = advance(straight, elapsed, _CLOSING)
        return *closed, grip, loaded, *advance(profile, elapsed - GRASPED, rise / speed, rise)

    return bear(roles, start, parameters, gaps_to_faces(roles.contacts, roles.thing, start), course)


def _hold(crew: str, profile: Profile, binding: Binding, start: State, parameters: Parameters) -> Policy:
    roles, still, whole = Roles.of(crew, binding), np.asarray(0.0), np.asarray(1.0)
    steady = (still, still, whole, whole, still, still)
    return bear(roles, start, parameters, (still,) * len(roles.hands), lambda elapsed: steady)


def _lower(crew: str, profile: Profile, binding: Binding, start: State, parameters: Parameters) -> Policy:
    roles = Roles.of(crew, binding)
    drop = height(start, roles.thing)
    duration = np.maximum(drop, FLOOR_TOLERANCE) / np.asarray(parameters.hyperparameters["speed"])

    def course(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        opened, opening = advance(straight_profile(), elapsed - duration, _CLOSING)
        grip = 1.0 - opened
        return opened, opening, grip, grip, *advance(profile, elapsed, duration, -drop)

    # The hands move away from their faces to their standby positions.
    return bear(roles, start, parameters, (np.asarray(-STANDBY_GAP),) * len(roles.hands), course)


def _able(crew: str) -> tuple[Literal, ...]:
    """Return the feasibility conditions of the object and of every hand in a crew."""
    hands = (conditions(OF_HAND, hand=slot, place=place, crew=crew) for slot, place in places_of(crew))
    return (*chain.from_iterable(hands), *conditions(OF_BOX))


def _at_places(crew: str) -> tuple[Literal, ...]:
    return tuple(AT_PLACE(slot, "object", place) for slot, place in places_of(crew))


def _together(
    action: str,
    mode: str,
    before: Literal,
    policy: Callable[..., Policy],
    profile: Profile,
    hyperparameters: tuple[Hyperparameter, ...] = (),
    keeps: tuple[Predicate, ...] = (),
    **told: Any,
) -> Block:
    """Return a block with the parts that LIFTING, HOLDING and LOWERING share. The entry condition `before` differs."""
    crew = MODES[mode]
    return make_pressing(
        f"{action}:{mode}",
        [slot for slot, _ in places_of(crew)],
        Liftable,
        entry=(before, *_at_places(crew), *_able(crew)),
        # A box moves straight up and down, so its feasibility facts do not change.
        keeps=(WITHIN_REACH, *keeps),
        hyperparameters=(squeezing(partial(_squeezes, crew)), *hyperparameters),
        policy=partial(policy, crew, profile),
        system=partial(bearing_system, crew),
        **told,
    )


def lifting(mode: str, primitive: DMP | None = None) -> Block:
    """Return one mode of LIFTING. The primitive, by default `straight_movement`, generates the rise of the box."""
    crew = MODES[mode]
    usual, what = partial(usual_height, crew), "height to which the box is lifted"
    return _together(
        "LIFTING",
        mode,
        STANDS("object"),
        _lift,
        profile_of(primitive),
        hyperparameters=(Hyperparameter("height", "m", LOWEST_LIFT, _HIGHEST, usual, what), _SPEED),
        exit=(RAISED("object"), ~STANDS("object"), *_at_places(crew)),
        duration=Duration(GRASPED, 12.0),
        taught=partial(lifting, mode),
        movement=Movement("object", "position", 1),
        description=f"{crew} close on a box, squeeze the box from opposite sides and lift it by friction",
    )


def holding(mode: str) -> Block:
    """Return one mode of HOLDING."""
    crew = MODES[mode]
    return _together(
        "HOLDING",
        mode,
        RAISED("object"),
        _hold,
        straight_profile(),
        keeps=(STANDS,),
        exit=(RAISED("object"), *_at_places(crew)),
        invariants=(RAISED("object"),),
        contacts=(),
        duration=Duration(1.0, 60.0),
        hold=True,
        description=f"{crew} keep a box in the air",
    )


def lowering(mode: str, primitive: DMP | None = None) -> Block:
    """Return one mode of LOWERING. The primitive, by default `straight_movement`, generates the descent of the box."""
    crew = MODES[mode]
    clear = (CLEAR_OF(slot, "object") for slot, _ in places_of(crew))
    return _together(
        "LOWERING",
        mode,
        RAISED("object"),
        _lower,
        profile_of(primitive),
        hyperparameters=(_SPEED,),
        exit=(STANDS("object"), ~RAISED("object"), *clear),
        duration=Duration(_CLOSING, 15.0),
        taught=partial(lowering, mode),
        movement=Movement("object", "position", 1),
        description=f"{crew} set a box down and release the box",
    )


BEARING = tuple(make(mode) for make in (lifting, holding, lowering) for mode in MODES)
