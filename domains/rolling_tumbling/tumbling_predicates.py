"""Predicates for tumbling."""

import numpy as np

from hybrid_tamp.authoring import FloatArray, Kind, Parameter, Predicate, State, Token
from hybrid_tamp.skills import (
    POSE,
    StaticEndEffector,
    bears_share,
    can_turn,
    competence,
    depth_in_workspace,
    dot,
    length_predicate,
    near,
    normal,
    one_by_one,
    within_reach,
    z_axis,
)

from .classes import Tumblable
from .edges import ability, axis_of, lowness, strength_needed
from .faces import EXPOSED_HOLD, FACE, HOLDS_HOLD, LEANS_HOLD, LOWERS_HOLD, POSTURES, TIPS_HOLD
from .standing import FLAT_TOLERANCE, SLENDERNESS, standing
from .tumbling_geometry import landing, outlook, place_at, sections, sides_around, to_the_right
from .turning_hands import ALIGNMENT, axes_of_turn

_HAND = Parameter("hand", StaticEndEffector)
_OBJECT = Parameter("object", Tumblable)
_FACE = Parameter("face", FACE)
_POSTURE = Parameter("posture", POSTURES)
FACE_TOLERANCE = 0.06
"""Largest distance at which a hand counts as at its place at a face [m]."""
_ABOVE = 0.05
_LEAST_OUTLOOK = 0.1
_LYING = np.cos(np.radians(18.0))
"""Vertical component of the normal above which a face is a top or bottom face, which no hand touches."""
_RESERVE = 1.6


def _deviation(state: State, hand: Token, thing: Token, face: str) -> FloatArray:
    """Return the angle ``(...)`` [rad] by which the axis of a hand stays off level or off parallel to a face.

    The angle is zero for a hand that can turn, because such a hand turns during its reach.
    """
    if can_turn(hand):
        return np.zeros(state.values.shape[:-1])
    along = z_axis(state, hand)
    sine = np.maximum(np.abs(dot(along, normal(state, thing, face))), np.abs(along[..., 2]))
    return np.asarray(np.arcsin(np.minimum(sine, 1.0)))


def _share(state: State, hand: Token, thing: Token, factor: float) -> tuple[float, float]:
    """Return the force [N] that a hand needs to tumble an object, and the force [N] that the hand bears.

    Both hands need the same force, because neither hand can push harder than the other hand can resist. While one hand
    changes faces, the other hand holds the box alone.
    """
    needed = min(strength_needed(thing, axis) for axis in axes_of_turn(state, hand, thing))
    return needed, float(hand["maximal_force"] / factor)


def _places(state: State, hand: Token, thing: Token) -> list[FloatArray]:
    """Return the places [m] of a hand beside the box and above the box, for the axis that needs the least workspace."""
    choices = [_places_around(state, hand, thing, axis) for axis in axes_of_turn(state, hand, thing)]
    return max(choices, key=lambda places: min((float(depth_in_workspace(hand, each)) for each in places), default=-1))


def _places_around(state: State, hand: Token, thing: Token, axis: int) -> list[FloatArray]:
    """Return the places [m] of a hand that turns the box about a body axis."""
    beside = [
        place_at(state, hand, thing, face)
        for face in sides_around(axis)
        if abs(float(normal(state, thing, face)[2])) < _LYING
    ]
    highest = float(np.hypot(*sections(thing, axis))) + hand["radius"] + thing.ground.height
    return [*beside, *(np.array([*place[:2], highest]) for place in beside)]


def _lowness(state: State, hand: Token, thing: Token) -> FloatArray:
    return np.asarray(max(lowness(thing, axis) for axis in axes_of_turn(state, hand, thing)))


def _ability(state: State, hand: Token, thing: Token, face: str, posture: str) -> FloatArray:
    """Return a margin that is positive if a hand can work at a face of a box in a posture.

    The axis of a hand that cannot turn must not cross the face. A hand that can turn must be able to turn the box about
    the edge, which no other fact about a hand with several possible edges states.
    """
    if (face, posture) not in EXPOSED_HOLD:
        return np.asarray(-1.0)
    if can_turn(hand):
        return np.asarray(ability(hand, thing, axis_of(face, posture)))
    return np.asarray(abs(outlook(state, hand, thing, face, posture)) - _LEAST_OUTLOOK)


def _outlook(state: State, hand: Token, thing: Token, face: str, posture: str) -> FloatArray:
    """Return a margin that is positive if a face points to the side of a hand. A hand above the box has both sides.

    Hands that can turn have no side, because they start in any orientation.
    """
    if can_turn(hand):
        return np.asarray(1.0)
    offset = float((state[hand, "position"] - state[thing, "position"]) @ to_the_right(state, hand))
    facing = outlook(state, hand, thing, face, posture)
    return np.asarray((facing if offset > 0 else -facing) if abs(offset) > _ABOVE else abs(facing)) - _LEAST_OUTLOOK


POSTURE = Predicate(
    "posture",
    (_OBJECT, _POSTURE),
    standing,
    distance=lambda state, thing, posture: FLAT_TOLERANCE - standing(state, thing, posture),
    unit="rad",
    scale=0.02,
    reads={"object": POSE},
    kind=Kind.FUNCTIONAL,
    value_of="posture",
    description="{object} is in posture {posture}",
    denial="{object} is not in posture {posture}",
)
AT_FACE = length_predicate(
    "at_face",
    (_HAND, _OBJECT, _FACE),
    near(FACE_TOLERANCE, place_at, ALIGNMENT),
    reads={"hand": POSE, "object": POSE},
    kind=Kind.MAINTAINED,
    description="{hand} is at the {face} face of {object}",
    denial="{hand} is not at the {face} face of {object}",
)
ALIGNED = competence(
    "aligned",
    (_HAND, _OBJECT, _FACE),
    lambda state, *values: ALIGNMENT.most - _deviation(state, *values),
    unit="rad",
    scale=0.05,
    distance=_deviation,
    # A hand that cannot turn keeps its axis, and for another hand the margin does not depend on the axis.
    reads={"object": ("orientation",)},
    description="{hand} can be level and parallel to the {face} face of {object}",
    denial="{hand} cannot turn, and its axis is not level or not parallel to the {face} face of {object}",
)
CAN_WORK_AT = competence(
    "can_work_at",
    (_HAND, _OBJECT, _FACE, _POSTURE),
    one_by_one(_ability),
    unit="1",
    scale=0.1,
    # A hand that cannot turn keeps its axis, and for another hand the margin does not depend on the axis.
    reads={"object": ("orientation",)},
    description="in posture {posture}, {hand} can work at the {face} face of {object}",
    denial="in posture {posture}, {hand} is not able to turn {object} about the edge at the {face} face",
)
ON_SIDE = competence(
    "on_side",
    (_HAND, _OBJECT, _FACE, _POSTURE),
    one_by_one(_outlook),
    unit="1",
    scale=0.1,
    # The side on which the hand starts does not change, so `reads` omits the positions and the axis of the hand.
    reads={"object": ("orientation",)},
    description="in posture {posture}, the {face} face of {object} points to the side on which {hand} starts",
    denial="in posture {posture}, the {face} face of {object} does not point to the side on which {hand} starts",
)
"""A preference: hands that change sides make detours, and have to wait for each other."""
STRONG_ENOUGH = bears_share(
    "strong_enough",
    (_HAND, _OBJECT),
    _share,
    _RESERVE,
    "ratio of the maximal force of a hand to the smallest force that tumbles the box; covers the squeeze",
    competence=True,
    reads={"object": ("orientation",)},
    description="{hand} is strong enough to tumble {object} together with a second hand",
    denial="{object} is too heavy to be tumbled by {hand} and a second hand",
)
WITHIN_REACH = within_reach(
    "within_reach",
    (_HAND, _OBJECT),
    _places,
    carried=True,
    reads={"object": POSE},
    description="{hand} can reach its positions beside and above {object}",
    denial="{hand} cannot reach its positions beside and above {object} within its workspace",
)
LOW_ENOUGH = competence(
    "low_enough",
    (_HAND, _OBJECT),
    one_by_one(_lowness),
    unit="1",
    scale=0.1,
    reads={"object": ("orientation",)},
    description=f"the edges of {{object}} perpendicular to {{hand}} have lengths with a ratio of at most {SLENDERNESS}",
    denial=f"the edges of {{object}} perpendicular to {{hand}} have lengths with a ratio above {SLENDERNESS}",
)
LANDS = competence(
    "lands",
    (_OBJECT, _FACE),
    one_by_one(landing),
    reads={"object": POSE},
    detail=lambda state, *values: (
        f"it would reach {-float(landing(state, *values)):.3g} m beyond {values[0].ground.edge}"
    ),
    description="{object} lands on the surface on which it rests if it is tumbled towards its {face} face",
    denial="{object} would not land on the surface on which it rests if it were tumbled towards its {face} face",
)


def _pair_relation(name: str, rows: set[tuple[str, str, str, str]], effect: str) -> Predicate:
    """Return a predicate of what two hands can do with a box. `effect` is a verb phrase, e.g. "tip a box"."""
    sorts = {"near": FACE, "far": FACE, "before": POSTURES, "outcome": POSTURES}
    parameters = tuple(Parameter(role, sort) for role, sort in sorts.items())
    hands = "hands at the {near} and {far} faces"
    return Predicate.relation(
        name, parameters, rows, description=f"{hands} can {effect}", denial=f"{hands} cannot {effect}"
    )


TIPS = _pair_relation("tips", TIPS_HOLD, "tip a box from {before} to {outcome}")
LOWERS = _pair_relation("lowers", LOWERS_HOLD, "lower a box from {before} to {outcome}")
LEANS = _pair_relation("leans", LEANS_HOLD, "tilt a box from {before} back to {outcome}")
HOLDS = Predicate.relation(
    "holds",
    (_FACE, _POSTURE),
    HOLDS_HOLD,
    description="a single hand at the {face} face can hold a box in posture {posture}",
    denial="a single hand at the {face} face cannot hold a box in posture {posture}",
)
EXPOSED = Predicate.relation(
    "exposed",
    (_FACE, _POSTURE),
    EXPOSED_HOLD,
    description="a hand can be placed at the {face} face of a box in posture {posture}",
    denial="no hand can be placed at the {face} face of a box in posture {posture}",
)
FEASIBLE_TUMBLING = (ALIGNED, CAN_WORK_AT, STRONG_ENOUGH, WITHIN_REACH, LOW_ENOUGH)
