"""Predicates for joint lifting."""

import numpy as np

from hybrid_tamp.authoring import FloatArray, Kind, Parameter, State, Token
from hybrid_tamp.skills import (
    FREE_TO_MOVE,
    HORIZONTAL,
    POSE,
    UP,
    Region,
    StaticEndEffector,
    at_place,
    bears_share,
    can_turn,
    competence,
    gap_to_face,
    heavy_enough,
    inside,
    length_predicate,
    level_with,
    within_reach,
)

from .classes import Liftable
from .load import RESERVE, bearable, friction, load, squeeze_for, wrist_moment
from .places import (
    CREW,
    FLOOR_TOLERANCE,
    PLACE,
    SPOTS,
    VERTICAL,
    contact_length,
    corner_heights,
    crew_at,
    height,
    place_at,
)

_HAND = Parameter("hand", StaticEndEffector)
_OBJECT = Parameter("object", Liftable)
_PLACE = Parameter("place", PLACE)
_CREW = Parameter("crew", CREW)
_REGION = Parameter("region", Region)
RAISED_HEIGHT = 0.1
"""Smallest height of the lowest point of a raised box above the floor [m]."""
LOWEST_LIFT = 0.11
"""Smallest height to which a box is lifted [m], which leaves 1 cm above `RAISED_HEIGHT`."""
PLACE_TOLERANCE = 0.03
"""Largest distance at which a hand counts as at its place [m]. The tolerance covers the standby gap and slip."""
_CLEAR = 0.005
_SKEW = float(np.tan(np.radians(0.5)))
"""Ratio of the force along a face to the squeeze, if a hand presses askew by half a degree."""
_LEAST_WEIGHT = 0.004
"""Smallest weight [N] of a box that hands lift without tilting it. A lighter box follows the errors of the hands."""
_TOUCHING = 0.03
"""Smallest length of the contact line between a hand and a face [m]."""
_ABREAST = 0.02
"""Smallest gap between two hands at the same face [m]."""


def _rise(state: State, thing: Token) -> FloatArray:
    return np.asarray(height(state, thing) - RAISED_HEIGHT)


def _footing(state: State, thing: Token) -> FloatArray:
    return np.asarray(FLOOR_TOLERANCE - np.abs(corner_heights(state, thing)).max(axis=-1))


def _clearance(state: State, hand: Token, thing: Token) -> FloatArray:
    nearer = np.maximum(gap_to_face(state, hand, thing, "left"), gap_to_face(state, hand, thing, "right"))
    return np.asarray(nearer - _CLEAR)


def room_above(state: State, hand: Token, thing: Token, place: str) -> FloatArray:
    """Return the height ``(...)`` [m] to which a hand can lift a box without leaving the top of its workspace."""
    return np.asarray(hand["workspace_upper"][2] - _on_the_floor(state, hand, thing, place)[..., 2])


def _on_the_floor(state: State, hand: Token, thing: Token, place: str) -> FloatArray:
    """Return the position ``(..., 3)`` [m] of a hand at its place while the box stands on the floor."""
    return np.asarray(place_at(state, hand, thing, place) - height(state, thing)[..., None] * UP)


def _lowest_lift(state: State, hand: Token, thing: Token, place: str) -> list[FloatArray]:
    """Return the positions ``(..., 3)`` [m] of a hand before and after the lowest lift of a box from the floor."""
    beside = _on_the_floor(state, hand, thing, place)
    return [beside, beside + LOWEST_LIFT * UP]


def destination(state: State, thing: Token, region: Token) -> FloatArray:
    """Return the position ``(..., 3)`` [m] of a box above the middle of a region, at the present height of the box."""
    return np.asarray(state[region, "position"] * HORIZONTAL + state[thing, "position"] * UP)


def _lift_at(state: State, hand: Token, thing: Token, place: str, region: Token) -> list[FloatArray]:
    """Return the positions ``(..., 3)`` [m] of a hand before and after the lowest lift of a box from a region."""
    there = state.replace({(thing.name, "position"): destination(state, thing, region)})
    return _lowest_lift(there, hand, thing, place)


def _room(hand: Token, thing: Token, place: str) -> float:
    """Return the least of three margins [m].

    The margins are the spare width of the face, the spare length of the contact line and, for a hand that can turn, the
    lever at which the squeeze makes up the spare moment of the wrist.
    """
    half_y = float(thing["half_extents"][1])
    wide = half_y - _ABREAST if SPOTS[place][1] else 2.0 * half_y
    room = min(wide - 2.0 * hand["radius"], contact_length(hand, thing) - _TOUCHING)
    if not can_turn(hand):
        return float(room)
    crew = crew_at(place)
    spare = float(hand["maximal_torque"]) - wrist_moment(hand, thing, crew)
    return float(min(room, spare / squeeze_for(thing, crew)))


def _misfit(state: State, hand: Token, thing: Token, place: str) -> str:
    """Return what is wrong with a hand at a place."""
    moment = wrist_moment(hand, thing, crew_at(place)) if can_turn(hand) else 0.0
    if moment > hand.properties.get("maximal_torque", moment):
        return f"its wrist would have to bear {moment:.3g} N m, but it bears at most {hand['maximal_torque']:.3g} N m"
    return f"off by {-_room(hand, thing, place):.4g} m"


def _grip(thing: Token) -> float:
    return friction(thing) - _SKEW


def _share(state: State, hand: Token, thing: Token, crew: str, factor: float) -> tuple[float, float]:
    return load(thing, crew), bearable(hand, thing, factor)


STANDS = length_predicate(
    "stands",
    (_OBJECT,),
    _footing,
    reads={"object": POSE},
    description="{object} stands on the floor",
    denial="{object} does not stand on the floor",
)
RAISED = length_predicate(
    "raised",
    (_OBJECT,),
    _rise,
    reads={"object": POSE},
    description=f"the lowest point of {{object}} is at least {RAISED_HEIGHT} m above the floor",
    denial=f"the lowest point of {{object}} is less than {RAISED_HEIGHT} m above the floor",
)
AT_PLACE = at_place(
    "at_place",
    (_HAND, _OBJECT, _PLACE),
    PLACE_TOLERANCE,
    place_at,
    VERTICAL,
    description="{hand} is at the {place} of {object}",
    denial="{hand} is not at the {place} of {object}",
)
CLEAR_OF = length_predicate(
    "clear_of",
    (_HAND, _OBJECT),
    _clearance,
    reads={"hand": ("position",), "object": POSE},
    kind=Kind.MAINTAINED,
    description="{hand} has released {object}",
    denial="{hand} has not released {object}",
)
# A box may be held above a region at any height, so the region confines the box to no disc of known thickness.
INSIDE = inside(Liftable, confines=None)
LEVEL_WITH = level_with(Liftable)
UPRIGHT = competence(
    "upright",
    (_HAND,),
    lambda state, hand: VERTICAL.most - VERTICAL.deviation(state, hand),
    unit="rad",
    scale=0.05,
    distance=VERTICAL.deviation,
    reads={"hand": ("orientation",)},
    # A hand that cannot turn keeps its axis, and a hand that can turn becomes upright during its reach.
    at_start=True,
    description="{hand} can be upright",
    denial="{hand} cannot turn and is not upright",
)
WITHIN_REACH = within_reach(
    "within_reach",
    (_HAND, _OBJECT, _PLACE),
    _lowest_lift,
    reads={"object": POSE},
    description="the {place} of {object} is in the workspace of {hand} throughout the lowest lift",
    denial="the {place} of {object} leaves the workspace of {hand} even during the lowest lift",
)
DESTINATION_WITHIN_REACH = within_reach(
    "destination_within_reach",
    (_HAND, _OBJECT, _PLACE, _REGION),
    _lift_at,
    # A carried box keeps its orientation, and the height above the floor does not matter.
    reads={"object": ("orientation",), "region": ("position",)},
    description="the {place} of {object} stays in the workspace of {hand} when {object} is in {region}",
    denial="the {place} of {object} leaves the workspace of {hand} when {object} is in {region}",
)
FITS = competence(
    "fits",
    (_HAND, _OBJECT, _PLACE),
    _room,
    detail=_misfit,
    description="{hand} fits at the {place} of {object}",
    denial="{hand} does not fit at the {place} of {object}",
)
BEARS = bears_share(
    "bears",
    (_HAND, _OBJECT, _CREW),
    _share,
    RESERVE,
    "ratio of the squeeze to the smallest squeeze without slip; covers acceleration and unequal shares",
    description="{hand}, as one of {crew}, can bear its share of the weight of {object} by friction",
    denial="{hand}, as one of {crew}, cannot bear its share of the weight of {object} by friction",
)
GRIPPABLE = competence(
    "grippable",
    (_OBJECT,),
    _grip,
    unit="1",
    scale=0.01,
    description="{object} is rough enough for hands that press slightly askew",
    denial="{object} is too smooth: it slips out between hands that press slightly askew",
)
HEAVY_ENOUGH = heavy_enough(Liftable, _LEAST_WEIGHT, "lift", "tilt it instead of lifting it")
OF_HAND = (BEARS, WITHIN_REACH, FITS, UPRIGHT)
"""Feasibility facts about each hand of a crew and the box."""
OF_BOX = (GRIPPABLE, HEAVY_ENOUGH, FREE_TO_MOVE)
"""Feasibility facts about the box."""
