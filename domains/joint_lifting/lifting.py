"""The blocks LIFTING, HOLDING and LOWERING (paper, Sec. II-E), for hands on opposite sides of a box.

Four hands, which may belong to two robots, can lift a box that is too heavy for two hands. The box is not attached to
any hand. LIFTING and LOWERING end by themselves. In HOLDING, the hands keep the box in the air until LOWERING begins.
"""

from functools import partial
from typing import Any

import numpy as np

from hybrid_tamp.authoring import (
    DMP,
    Binding,
    Block,
    Duration,
    FloatArray,
    Hyperparameter,
    KeyPose,
    Movement,
    Parameters,
    Predicate,
    Profile,
    State,
)
from hybrid_tamp.skills import STANDBY_GAP, UP, advance, gaps_to_faces, profile_of, straight_profile

from .bearing import Plan
from .places import FLOOR_TOLERANCE, SLOTS, VERTICAL, Roles, height, place_at, places_of
from .predicates import (
    CLEAR_OF,
    INSIDE,
    LOWEST_LIFT,
    RAISED,
    RAISED_HEIGHT,
    STANDS,
    WITHIN_REACH,
    room_above,
)
from .together import MODES, at_places, make_together

_CLOSING = 0.3
"""Time in which hands close on a box or move away from a box [s]."""
GRASPED = 0.5
"""Time from the start of LIFTING until the hands squeeze the box fully and bear its weight [s]."""
_USUAL, _HIGHEST = 0.15, 0.3
"""Height of a lift by default, and its largest height [m]."""
_KEY_POSES = 6
"""Number of heights of a box at which fixed bodies are compared with the box and its hands."""
_SPEED = Hyperparameter("speed", "m/s", 0.03, 0.2, lambda b, s: np.asarray(0.1), "mean vertical speed")


def usual_height(crew: str, binding: Binding, state: State) -> FloatArray:
    """Return the default height ``(...)`` [m] of a lift, or a lower height if a hand would leave its workspace."""
    roles = Roles.of(crew, binding)
    room = np.min([room_above(state, hand, roles.thing, place) for hand, place in roles.hands], axis=0)
    return np.asarray(np.clip(room, LOWEST_LIFT, _USUAL))


def _upwards(heights: tuple[FloatArray, FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Return the displacement [m] and velocity [m/s], each ``(..., 3)``, for a height [m] and its rate [m/s]."""
    rise, rising = heights
    return UP * rise[..., None], UP * rising[..., None]


def _lift(roles: Roles, profile: Profile, binding: Binding, start: State, parameters: Parameters) -> Plan:
    straight = straight_profile()
    speed, rise = (np.asarray(parameters.hyperparameters[name]) for name in ("speed", "height"))

    def course(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        grip = straight.share(elapsed / GRASPED)
        # Before contact, a hand that compensated its share of the weight would rise.
        loaded = straight.share((elapsed - _CLOSING) / (GRASPED - _CLOSING))
        closed = advance(straight, elapsed, _CLOSING)
        return *closed, grip, loaded, *_upwards(advance(profile, elapsed - GRASPED, rise / speed, rise))

    return Plan(gaps_to_faces(roles.contacts, roles.thing, start), course, GRASPED + rise / speed)


def _hold(roles: Roles, profile: Profile, binding: Binding, start: State, parameters: Parameters) -> Plan:
    still = np.asarray(0.0)

    def course(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        none, whole = np.zeros_like(elapsed), np.ones_like(elapsed)
        return none, none, whole, whole, *_upwards((none, none))

    return Plan((still,) * len(roles.hands), course, still)


def _lower(roles: Roles, profile: Profile, binding: Binding, start: State, parameters: Parameters) -> Plan:
    drop = height(start, roles.thing)
    duration = np.maximum(drop, FLOOR_TOLERANCE) / np.asarray(parameters.hyperparameters["speed"])

    def course(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        opened, opening = advance(straight_profile(), elapsed - duration, _CLOSING)
        grip = 1.0 - opened
        return opened, opening, grip, grip, *_upwards(advance(profile, elapsed, duration, -drop))

    # The hands move away from their faces to their standby positions.
    return Plan((np.asarray(-STANDBY_GAP),) * len(roles.hands), course, duration + _CLOSING)


def _vertically(*args: Any, keeps: tuple[Predicate, ...] = (), **told: Any) -> Block:
    """Return a block of a box that moves only up and down, so its feasibility facts and its region do not change."""
    return make_together(*args, keeps=(WITHIN_REACH, INSIDE, *keeps), vertical=("object",), **told)


def _rising(crew: str, binding: Binding, start: State) -> list[KeyPose]:
    """Return the poses of the box and of its hands while the box rises to the smallest height of a raised box."""
    return _at_heights(Roles.of(crew, binding), start, np.linspace(0.0, RAISED_HEIGHT, _KEY_POSES))


def _sinking(crew: str, binding: Binding, start: State) -> list[KeyPose]:
    """Return the poses of the box and of its hands while the box sinks from this height to the floor."""
    roles = Roles.of(crew, binding)
    return _at_heights(roles, start, np.linspace(0.0, RAISED_HEIGHT, _KEY_POSES) - height(start, roles.thing))


def _at_heights(roles: Roles, start: State, heights: FloatArray) -> list[KeyPose]:
    """Return the poses of a box and of the hands that touch it, at heights above the start [m]."""
    thing = roles.thing
    poses = [("object", start[thing, "position"], start[thing, "orientation"])]
    for (hand, place), slot in zip(roles.hands, SLOTS, strict=False):
        poses.append((slot, place_at(start, hand, thing, place, 0.0), VERTICAL.orientation(start, hand)))
    return [KeyPose(slot, at + each * UP, turn, FLOOR_TOLERANCE) for each in heights for slot, at, turn in poses]


def lifting(mode: str, primitive: DMP | None = None) -> Block:
    """Return one mode of LIFTING. The primitive, by default `straight_movement`, generates the rise of the box."""
    crew = MODES[mode]
    usual, what = partial(usual_height, crew), "height to which the box is lifted"
    return _vertically(
        "LIFTING",
        mode,
        (STANDS("object"),),
        _lift,
        profile_of(primitive),
        hyperparameters=(Hyperparameter("height", "m", LOWEST_LIFT, _HIGHEST, usual, what), _SPEED),
        exit=(RAISED("object"), ~STANDS("object"), *at_places(crew)),
        duration=Duration(GRASPED, 12.0),
        key_poses=partial(_rising, crew),
        taught=partial(lifting, mode),
        movement=Movement("object", "position", 1),
        description=f"{crew} close on a box, squeeze the box from opposite sides and lift it by friction",
    )


def holding(mode: str) -> Block:
    """Return one mode of HOLDING."""
    crew = MODES[mode]
    return _vertically(
        "HOLDING",
        mode,
        (RAISED("object"),),
        _hold,
        straight_profile(),
        keeps=(STANDS,),
        exit=(RAISED("object"), *at_places(crew)),
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
    return _vertically(
        "LOWERING",
        mode,
        (RAISED("object"),),
        _lower,
        profile_of(primitive),
        # Hands that have carried the box elsewhere may have started on another side of its present place.
        hyperparameters=(_SPEED,),
        exit=(STANDS("object"), ~RAISED("object"), *clear),
        duration=Duration(_CLOSING, 15.0),
        key_poses=partial(_sinking, crew),
        taught=partial(lowering, mode),
        movement=Movement("object", "position", 1),
        description=f"{crew} set a box down and release the box",
    )
