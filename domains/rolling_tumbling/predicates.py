"""What the conditions of rolling speak of."""

import numpy as np

from hybrid_tamp.authoring import FloatArray, Kind, Parameter, Predicate, State, Token

from ..common.classes import Region, StaticEndEffector
from ..common.predicates import inside
from .classes import Rollable
from .geometry import axis, dot, heading, standby, touching, working_height

_HAND = Parameter("hand", StaticEndEffector)
_OBJECT = Parameter("object", Rollable)
_REGION = Parameter("region", Region)
_TILT_TOLERANCE = np.sin(np.radians(3.0))
_STANDBY_TOLERANCE = 0.025
_DRIFT = 0.002
"""How far a rolling thing may drift off its line [m]: so much less is not said to be impossible before it is tried."""


def _close_to_standby(state: State, hand: Token, thing: Token, region: Token) -> FloatArray:
    offset = state[hand, "position"] - standby(state, hand, thing, region)
    return np.asarray(_STANDBY_TOLERANCE - np.linalg.norm(offset, axis=-1))


def _levelness(state: State, thing: Token) -> FloatArray:
    return np.asarray(_TILT_TOLERANCE - np.abs(axis(state, thing)[..., 2]))


def _closeness_of_line(state: State, thing: Token, region: Token) -> FloatArray:
    """How much nearer than the region's radius the rolling line passes its centre, or may pass it by drifting."""
    offset = (state[region, "position"] - state[thing, "position"]) * np.array([1.0, 1.0, 0.0])
    along = dot(offset, heading(state, thing))
    aside = np.sqrt(np.maximum(0.0, dot(offset, offset) - along**2))
    return np.asarray(region["radius"] + _DRIFT - aside)


def _room(state: State, hand: Token, thing: Token, region: Token) -> FloatArray:
    """Least distance inside the workspace of the hand's place when the thing has come to the region.

    From which side it comes is not known before search, so the better one counts: the fact is necessary wherever the
    thing may be by then. Whether a hand really stayed in its workspace is measured by IN_WORKSPACE.
    """
    along = heading(state, thing)
    ends = []
    for direction in (along, -along):
        behind = touching(state, hand, thing, direction)
        place = state[region, "position"] - direction * behind[..., None]
        height = working_height(state, hand, thing)
        ends.append(_depth_in_workspace(hand, np.concatenate([place[..., :2], height[..., None]], axis=-1)))
    return np.asarray(np.maximum(*ends))


def _depth_in_workspace(hand: Token, position: FloatArray) -> FloatArray:
    lower, upper = np.asarray(hand["workspace_lower"]), np.asarray(hand["workspace_upper"])
    return np.asarray(np.minimum(position - lower, upper - position).min(axis=-1))


def _own_room(state: State, hand: Token) -> FloatArray:
    return _depth_in_workspace(hand, state[hand, "position"])


INSIDE = inside(Rollable)
BEHIND = Predicate(
    "behind",
    (_HAND, _OBJECT, _REGION),
    _close_to_standby,
    unit="m",
    scale=0.01,
    reads={"hand": ("position",), "object": ("position", "orientation"), "region": ("position",)},
    kind=Kind.MAINTAINED,
    description="{hand} stands by behind {object} as seen from {region}",
    denial="{hand} does not stand by behind {object} as seen from {region}",
)
LIES_ON_SIDE = Predicate(
    "lies_on_side",
    (_OBJECT,),
    _levelness,
    unit="1",
    scale=0.05,
    reads={"object": ("orientation",)},
    kind=Kind.STATIC,
    description="{object} lies with its axis of rotation level",
    denial="the axis of rotation of {object} is not level",
)
ON_ROLLING_LINE = Predicate(
    "on_rolling_line",
    (_OBJECT, _REGION),
    _closeness_of_line,
    unit="m",
    scale=0.01,
    reads={"object": ("position", "orientation"), "region": ("position",)},
    kind=Kind.STATIC,
    description="{region} lies on the line along which {object} rolls, perpendicular to its axis",
    denial="{region} is not on the rolling line of {object}",
)
WITHIN_WORKSPACE = Predicate(
    "within_workspace",
    (_HAND, _OBJECT, _REGION),
    _room,
    unit="m",
    scale=0.01,
    reads={"object": ("position", "orientation"), "region": ("position",)},
    kind=Kind.STATIC,
    description="{hand} can be behind {object} at {region} within its workspace",
    denial="{hand} cannot be behind {object} at {region} within its workspace",
)
IN_WORKSPACE = Predicate(
    "in_workspace",
    (_HAND,),
    _own_room,
    unit="m",
    scale=0.01,
    reads={"hand": ("position",)},
    description="{hand} is within its workspace",
    denial="{hand} is not within its workspace",
)
