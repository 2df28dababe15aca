"""The block CARRYING: hands that bear a box carry the box sideways to a region.

The hands keep pressing on the box, and the box keeps its height and its orientation. The box follows a straight line to
a place above the middle of the region, or a path around bodies in the way. Then the hands hold the box there.
"""

from functools import partial

import numpy as np

from hybrid_tamp.authoring import (
    ANY,
    DMP,
    Binding,
    Block,
    Duration,
    FloatArray,
    Hyperparameter,
    Movement,
    Parameters,
    Profile,
    State,
    Target,
)
from hybrid_tamp.skills import Region, Timetable, curve_along, get_tokens, profile_of

from .bearing import Plan, carried_system
from .places import Roles
from .predicates import DESTINATION_WITHIN_REACH, INSIDE, LEVEL_WITH, RAISED, STANDS, destination
from .together import MODES, at_places, for_each_hand, make_together

_SPEED = Hyperparameter("speed", "m/s", 0.05, 0.4, lambda b, s: np.asarray(0.2), "mean speed along the path")
_WHOLE = np.asarray(1.0)
_SHORTEST = 0.02
"""Length of a path that takes as long as every shorter path [m]."""


def _carry(roles: Roles, profile: Profile, binding: Binding, start: State, parameters: Parameters) -> Plan:
    origin, goal = start[roles.thing, "position"].copy(), _goal(binding, start)
    curve = curve_along(origin, parameters.path, goal)
    duration = np.maximum(curve.length, _SHORTEST) / np.asarray(parameters.hyperparameters["speed"])
    timetable = Timetable(lambda elapsed: curve.at(elapsed, duration, profile), start)

    def course(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        position, velocity = timetable(elapsed)
        still = np.zeros_like(elapsed)
        return still, still, _WHOLE, _WHOLE, position - origin, velocity

    return Plan((np.asarray(0.0),) * len(roles.hands), course, duration)


def _goal(binding: Binding, state: State) -> FloatArray:
    return destination(state, *get_tokens(binding, "object", "region"))


def _outcome(crew: str, binding: Binding, state: State) -> State:
    roles = Roles.of(crew, binding)
    way = _goal(binding, state) - state[roles.thing, "position"]
    moved = (roles.thing, *(hand for hand, _ in roles.hands))
    return state.replace({(token.name, "position"): state[token, "position"] + way for token in moved})


def carrying(mode: str, primitive: DMP | None = None) -> Block:
    """Return one mode of CARRYING. The primitive, by default `straight_movement`, generates the way along the path."""
    crew = MODES[mode]
    return make_together(
        "CARRYING",
        mode,
        (RAISED("object"), LEVEL_WITH("object", "region"), *for_each_hand(crew, (DESTINATION_WITHIN_REACH,))),
        _carry,
        profile_of(primitive),
        hyperparameters=(_SPEED,),
        system=carried_system,
        targets=(Target("region", Region, ("position",)),),
        exit=(RAISED("object"), ~INSIDE("object", ANY), INSIDE("object", "region"), *at_places(crew)),
        invariants=(RAISED("object"),),
        keeps=(STANDS,),
        contacts=(),
        ends={"object": ("region",)},
        duration=Duration(0.3, 120.0),
        hold=True,
        path="object",
        outcome=partial(_outcome, crew),
        taught=partial(carrying, mode),
        movement=Movement("object", "position", 1),
        description=f"{crew} carry a box sideways to a region, and keep the box in the air there",
    )
