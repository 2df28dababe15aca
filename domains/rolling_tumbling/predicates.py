"""Predicates for rolling."""

import numpy as np

from hybrid_tamp.authoring import FloatArray, Parameter, State, Token
from hybrid_tamp.skills import (
    HORIZONTAL,
    POSE,
    Region,
    StaticEndEffector,
    competence,
    depth_in_workspace,
    dot,
    inside,
    level_with,
    outside,
    physical_bound,
)

from .classes import Rollable
from .geometry import axis, gap_between, heading
from .push import ROLL

_HAND = Parameter("hand", StaticEndEffector)
_OBJECT = Parameter("object", Rollable)
_REGION = Parameter("region", Region)
_TILT_TOLERANCE = np.sin(np.radians(3.0))
_PRESSED = 0.005
"""Largest depth [m] to which a hand that pushes an object presses into it."""
_DRIFT = 0.002
"""Largest drift off its line at which a rolling object still counts as on the line [m]."""


def _levelness(state: State, thing: Token) -> FloatArray:
    return np.asarray(_TILT_TOLERANCE - np.abs(axis(state, thing)[..., 2]))


def _closeness_of_line(state: State, thing: Token, region: Token) -> FloatArray:
    """Return the region's radius plus `_DRIFT`, minus the distance between rolling line and region's centre [m]."""
    offset = (state[region, "position"] - state[thing, "position"]) * HORIZONTAL
    along = dot(offset, heading(state, thing))
    aside = np.sqrt(np.maximum(0.0, dot(offset, offset) - along**2))
    return np.asarray(region["radius"] + _DRIFT - aside)


def _room(state: State, hand: Token, thing: Token, region: Token) -> FloatArray:
    """Return the depth [m] of the hand in its workspace when the object has arrived in the region.

    The direction of the roll is unknown before the search, so the result is the larger of the depths for both
    directions. Every roll to the region thus needs a positive result, regardless of the object's initial position. The
    exit condition IN_WORKSPACE checks the hand after the roll.
    """
    along, binding = heading(state, thing), {"hand": hand, "object": thing, "region": region}
    state = ROLL.aligned(binding, state)
    height = ROLL.beside(binding, state)[..., 2:]
    ends = []
    for direction in (along, -along):
        place = state[region, "position"] - direction * ROLL.touching(binding, state, direction)[..., None]
        ends.append(depth_in_workspace(hand, np.concatenate([place[..., :2], height], axis=-1)))
    return np.asarray(np.maximum(*ends))


INSIDE = inside(Rollable)
LEVEL_WITH = level_with(Rollable)
OUTSIDE = outside(Rollable, lambda state, hand, thing: gap_between(state, hand, thing) + _PRESSED)
LIES_ON_SIDE = competence(
    "lies_on_side",
    (_OBJECT,),
    _levelness,
    unit="1",
    scale=0.05,
    reads={"object": ("orientation",)},
    description="the axis of rotation of {object} is level",
    denial="the axis of rotation of {object} is not level",
)
ON_ROLLING_LINE = competence(
    "on_rolling_line",
    (_OBJECT, _REGION),
    _closeness_of_line,
    reads={"object": POSE, "region": ("position",)},
    description="{region} is on the rolling line of {object}, a line perpendicular to the object's axis",
    denial="{region} is not on the rolling line of {object}",
)
WITHIN_WORKSPACE = physical_bound(
    "within_workspace",
    (_HAND, _OBJECT, _REGION),
    _room,
    reads={"object": POSE, "region": ("position",)},
    description="{hand} can push {object} to {region} without leaving the workspace of the hand",
    denial="{hand} cannot push {object} to {region} without leaving the workspace of the hand",
)
