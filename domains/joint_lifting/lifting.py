"""The blocks LIFTING, HOLDING and LOWERING (paper, Sec. II-E), for hands on opposite sides of a box.

Each block has two modes: ``two``, with one hand on each side, and ``four``, with two hands on each side. Four hands,
which may belong to two robots, can lift a box that is too heavy for two hands. The box is not attached to any hand.
LIFTING and LOWERING end by themselves. In HOLDING, the hands keep the box in the air until LOWERING begins.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from hybrid_tamp.authoring import (
    DMP,
    FLOOR,
    Binding,
    Block,
    Duration,
    FloatArray,
    Hyperparameter,
    Hyperparameters,
    Literal,
    Movement,
    Parameters,
    Policy,
    Profile,
    Slot,
    State,
)
from hybrid_tamp.skills import (
    AT_REST,
    BODY,
    IN_WORKSPACE,
    MOTION,
    REST_SPEED,
    UP,
    StaticEndEffector,
    profile_of,
    round_up,
    straight_profile,
)

from .bearing import Course, Roles, bearing, bearing_system, places_of, squeezing
from .classes import Liftable
from .heights import rising, usual_height
from .places import FLOOR_TOLERANCE, STANDBY_GAP, corner_heights, gap_at, place_at
from .predicates import (
    AT_PLACE,
    BEARS,
    CLEAR_OF,
    FEASIBLE,
    FITS,
    GRIPPABLE,
    HEAVY_ENOUGH,
    ON_SIDE,
    OUTSIDE,
    RAISED,
    RAISED_HEIGHT,
    STANDS,
    UPRIGHT,
    WITHIN_REACH,
)

MODES = {"two": "two hands", "four": "four hands"}
"""Maps each mode to its crew."""
_CLOSING = 0.3
"""Time in which hands close on a box or move away from a box [s]."""
GRASPED = 0.5
"""Time from the start of LIFTING until the hands squeeze the box fully and bear its weight [s]."""
_HELD = 1.0
"""Minimum duration of HOLDING [s]."""
_SPEED = Hyperparameter("speed", "m/s", 0.03, 0.2, lambda b, s: np.asarray(0.1), "mean vertical speed")


def _lift(crew: str, profile: Profile, binding: Binding, start: State, parameters: Parameters) -> Policy:
    roles = Roles.of(crew, binding)
    chosen = parameters.hyperparameters
    speed, height, squeeze = (np.asarray(chosen[name]) for name in ("speed", "height", "squeeze"))
    duration = height / speed

    def course(elapsed: FloatArray) -> Course:
        closing, rising = elapsed / _CLOSING, (elapsed - GRASPED) / duration
        closed, rate = straight_profile().share(closing), straight_profile().rate(closing) / _CLOSING
        grip = straight_profile().share(elapsed / GRASPED)
        # Before contact, a hand that compensated its share of the weight would rise.
        loaded = straight_profile().share((elapsed - _CLOSING) / (GRASPED - _CLOSING))
        rise, climb = height * profile.share(rising), height * profile.rate(rising) / duration
        return Course(closed, rate, grip, loaded, rise, climb)

    gaps = tuple(gap_at(start, hand, roles.thing, place) for hand, place in roles.hands)
    return bearing(roles, start, squeeze, gaps, course)


def _hold(crew: str, profile: Profile, binding: Binding, start: State, parameters: Parameters) -> Policy:
    roles = Roles.of(crew, binding)
    still, whole = np.asarray(0.0), np.asarray(1.0)
    gaps = (still,) * len(roles.hands)
    squeeze = np.asarray(parameters.hyperparameters["squeeze"])
    return bearing(roles, start, squeeze, gaps, lambda elapsed: Course(still, still, whole, whole, still, still))


def _lower(crew: str, profile: Profile, binding: Binding, start: State, parameters: Parameters) -> Policy:
    roles = Roles.of(crew, binding)
    speed, squeeze = (np.asarray(parameters.hyperparameters[name]) for name in ("speed", "squeeze"))
    drop = corner_heights(start, roles.thing).min(axis=-1)
    duration = _falling(drop, speed)

    def course(elapsed: FloatArray) -> Course:
        sinking, opening = elapsed / duration, (elapsed - duration) / _CLOSING
        opened, rate = straight_profile().share(opening), straight_profile().rate(opening) / _CLOSING
        grip = 1.0 - opened
        rise, climb = -drop * profile.share(sinking), -drop * profile.rate(sinking) / duration
        return Course(opened, rate, grip, grip, rise, climb)

    # The hands move away from their faces to their standby positions.
    gaps = (np.asarray(-STANDBY_GAP),) * len(roles.hands)
    return bearing(roles, start, squeeze, gaps, course)


def _falling(drop: FloatArray, speed: FloatArray) -> FloatArray:
    return np.asarray(np.maximum(drop, FLOOR_TOLERANCE) / speed)


def _lifted(crew: str, profile: Profile, binding: Binding, state: State, chosen: Hyperparameters) -> float:
    height, speed = float(chosen["height"]), float(chosen["speed"])
    arrival = float(profile.arrival(height, height / speed, height - RAISED_HEIGHT, REST_SPEED))
    return round_up(GRASPED + arrival)


def _lowered(crew: str, binding: Binding, state: State, chosen: Hyperparameters) -> float:
    drop = corner_heights(state, Roles.of(crew, binding).thing).min(axis=-1)
    return round_up(float(_falling(drop, np.asarray(chosen["speed"]))) + _CLOSING)


def _up(crew: str, binding: Binding, state: State) -> State:
    """Return the state with the box lifted and the hands at its faces."""
    return _at(Roles.of(crew, binding), state, usual_height(crew, binding, state)[..., None] * UP, 0.0)


def _down(crew: str, binding: Binding, state: State) -> State:
    """Return the state with the box on the floor and the hands in their standby positions beside the box."""
    roles = Roles.of(crew, binding)
    return _at(roles, state, -UP * corner_heights(state, roles.thing).min(axis=-1)[..., None], STANDBY_GAP)


def _at(roles: Roles, state: State, way: FloatArray, gap: float) -> State:
    after = state.replace({(roles.thing.name, "position"): state[roles.thing, "position"] + way})
    return after.replace(
        {(hand.name, "position"): place_at(after, hand, roles.thing, place, gap) for hand, place in roles.hands}
    )


def _able(crew: str) -> tuple[Literal, ...]:
    """Return the feasibility conditions of the object and of every hand in a crew."""
    hands = (
        literal
        for slot, place in places_of(crew)
        for literal in (
            BEARS(slot, "object", crew),
            ON_SIDE(slot, "object", place),
            WITHIN_REACH(slot, "object", place),
            FITS(slot, "object", place),
            UPRIGHT(slot),
        )
    )
    return (*hands, GRIPPABLE("object"), HEAVY_ENOUGH("object"))


def _at_places(crew: str) -> tuple[Literal, ...]:
    return tuple(AT_PLACE(slot, "object", place) for slot, place in places_of(crew))


def _together(action: str, mode: str, duration: Duration, policy: Callable[..., Policy], profile: Profile) -> Block:
    """Return a block with the parts that LIFTING, HOLDING and LOWERING share, e.g. the conditions on the hands."""
    crew = MODES[mode]
    slots = [slot for slot, _ in places_of(crew)]
    return Block(
        name=f"{action}:{mode}",
        slots=(*(Slot(slot, StaticEndEffector) for slot in slots), Slot("object", Liftable)),
        anchor="object",
        entry=(*_at_places(crew), *_able(crew)),
        exit=(AT_REST("object"), *(AT_REST(slot) for slot in slots)),
        invariants=tuple(map(IN_WORKSPACE, slots)),
        writes={**{slot: MOTION for slot in slots}, "object": BODY},
        # A box moves straight up and down, so its feasibility facts do not change.
        keeps=(*FEASIBLE, OUTSIDE),
        allowed_contacts=(*((slot, "object") for slot in slots), ("object", FLOOR)),
        hyperparameters=(squeezing(crew),),
        duration=duration,
        policy=partial(policy, crew, profile),
        system=partial(bearing_system, crew),
    )


def lifting(mode: str, primitive: DMP | None = None) -> Block:
    """Return one mode of LIFTING. The primitive, by default `straight_movement`, generates the rise of the box."""
    profile, crew = profile_of(primitive), MODES[mode]
    block = _together("LIFTING", mode, Duration(GRASPED, 12.0, partial(_lifted, crew, profile)), _lift, profile)
    return replace(
        block,
        entry=(STANDS("object"), *block.entry),
        exit=(RAISED("object"), ~STANDS("object"), *_at_places(crew), *block.exit),
        hyperparameters=(*block.hyperparameters, rising(crew), _SPEED),
        taught=partial(lifting, mode),
        movement=Movement("object", "position", 1),
        outcome=partial(_up, crew),
        description=f"{crew} close on a box, squeeze the box from opposite sides and lift it by friction",
    )


def holding(mode: str) -> Block:
    """Return one mode of HOLDING."""
    crew = MODES[mode]
    block = _together(
        "HOLDING", mode, Duration(_HELD, 60.0, lambda binding, state, chosen: _HELD), _hold, straight_profile()
    )
    return replace(
        block,
        entry=(RAISED("object"), *block.entry),
        exit=(RAISED("object"), *_at_places(crew), *block.exit),
        keeps=(*block.keeps, STANDS),
        hold=True,
        invariants=(*block.invariants, RAISED("object")),
        allowed_contacts=tuple((slot, "object") for slot, _ in places_of(crew)),
        description=f"{crew} keep a box in the air",
    )


def lowering(mode: str, primitive: DMP | None = None) -> Block:
    """Return one mode of LOWERING. The primitive, by default `straight_movement`, generates the descent of the box."""
    profile, crew = profile_of(primitive), MODES[mode]
    block = _together("LOWERING", mode, Duration(_CLOSING, 15.0, partial(_lowered, crew)), _lower, profile)
    clear = (CLEAR_OF(slot, "object") for slot, _ in places_of(crew))
    return replace(
        block,
        entry=(RAISED("object"), *block.entry),
        exit=(STANDS("object"), ~RAISED("object"), *clear, *block.exit),
        hyperparameters=(*block.hyperparameters, _SPEED),
        taught=partial(lowering, mode),
        movement=Movement("object", "position", 1),
        outcome=partial(_down, crew),
        description=f"{crew} set a box down and release the box",
    )


BEARING = tuple(make(mode) for make in (lifting, holding, lowering) for mode in MODES)
