"""TIPPING (paper, D2 and D4): two hands turn a box about one of its edges, in three modes; TILTING (D3): one holds it.

``opposite``: with hands on opposite sides the box is tipped from lying flat to leaning over the edge (D2).
``lower``: with hands below and above it comes down on its next face (D2 again, with another outcome).
``adjacent``: with hands on the two faces beside the edge it is tilted back until it leans the other way (D4).
In TILTING the hand on the face over which the box leans holds it while another one moves.
"""

from functools import partial

import numpy as np

from hybrid_tamp.authoring import (
    DMP,
    GRAVITY,
    Binding,
    Block,
    Duration,
    FloatArray,
    Hyperparameter,
    Hyperparameters,
    Movement,
    Predicate,
    Profile,
    Slot,
    State,
    Target,
)

from ..common.classes import StaticEndEffector
from ..common.predicates import AT_REST, REST_SPEED
from ..common.primitives import profile_of
from ..common.resting import stay
from ..common.roles import BODY, MOTION, get_symbol, get_token
from ..common.servos import hand_system
from ..common.timetable import round_up
from .classes import Tumblable
from .faces import FACE, POSTURES
from .predicates import IN_WORKSPACE, INSIDE, LIES_ON_SIDE, ON_ROLLING_LINE, WITHIN_WORKSPACE
from .standing import FLAT_TOLERANCE
from .tumbling_geometry import half_extent, nominal_tilt
from .tumbling_predicates import (
    AT_FACE,
    FEASIBLE_TUMBLING,
    HOLDS,
    LEANS,
    LOW_ENOUGH,
    LOWERS,
    POSTURE,
    SQUEEZE,
    STRONG_ENOUGH,
    TIPS,
    WITHIN_REACH,
)
from .turning import CLOSING, Roles, after_turning, make_turning, turning_system, turning_time

_LEAN_SQUEEZE = 25.0
_SETTLING = 0.05
_KEPT = (*FEASIBLE_TUMBLING, IN_WORKSPACE, INSIDE, LIES_ON_SIDE, ON_ROLLING_LINE, WITHIN_WORKSPACE)


def _opposed(binding: Binding, state: State) -> FloatArray:
    return np.asarray(SQUEEZE * GRAVITY * get_token(binding, "object")["mass"])


def _light(binding: Binding, state: State) -> FloatArray:
    return np.asarray(_LEAN_SQUEEZE)


def _expected(binding: Binding, state: State, hyperparameters: Hyperparameters, profile: Profile) -> float:
    """Return the time [s] to close and to turn between the two postures within tolerance, from any initial pose."""
    roles = Roles.of(binding)
    angle = roles.wanted - nominal_tilt(roles.thing, get_symbol(binding, "before"), *roles.edge)
    # The hands move fastest; their distance from the edge is about the width of the box's section.
    one, other = (half_extent(roles.thing, face) for face in roles.edge)
    width = 2.0 * float(np.hypot(one, other))
    turn = turning_time(angle, float(hyperparameters["rate"]))
    return round_up(CLOSING + profile.arrival(angle, turn, FLAT_TOLERANCE, REST_SPEED / width) + _SETTLING)


def _tipping(
    mode: str, relation: Predicate, squeeze: Hyperparameter, description: str, primitive: DMP | None = None
) -> Block:
    """Return one mode; its primitive in one dimension moves the tilt, by default a straight movement."""
    profile = profile_of(primitive)
    return Block(
        name=f"TIPPING:{mode}",
        slots=(Slot("first", StaticEndEffector), Slot("second", StaticEndEffector), Slot("object", Tumblable)),
        anchor="object",
        targets=(Target("near", FACE), Target("far", FACE), Target("before", POSTURES), Target("outcome", POSTURES)),
        entry=(
            relation("near", "far", "before", "outcome"),
            POSTURE("object", "before"),
            AT_FACE("first", "object", "near"),
            AT_FACE("second", "object", "far"),
            *(
                feasible(hand, "object")
                for hand in ("first", "second")
                for feasible in (STRONG_ENOUGH, WITHIN_REACH, LOW_ENOUGH)
            ),
        ),
        exit=(
            POSTURE("object", "outcome"),
            AT_FACE("first", "object", "near"),
            AT_FACE("second", "object", "far"),
            AT_REST("object"),
            AT_REST("first"),
            AT_REST("second"),
        ),
        writes={"first": MOTION, "second": MOTION, "object": BODY},
        # A box turns about the axis of the hands only and moves by little more than its own size, so feasibility does
        # not change. Boxes do not roll, so the facts of rolling do not change either. The hands' workspace is not
        # measured in the blocks of tumbling yet.
        keeps=_KEPT,
        hyperparameters=(
            Hyperparameter("rate", "rad/s", 0.1, 1.0, lambda b, s: np.asarray(0.5), "mean rate of the turn"),
            squeeze,
        ),
        duration=Duration(CLOSING, 20.0, partial(_expected, profile=profile)),
        hold=True,
        policy=partial(make_turning, profile=profile),
        system=turning_system,
        taught=partial(_tipping, mode, relation, squeeze, description),
        movement=Movement("object", "orientation", 1),
        outcome=after_turning,
        description=description,
    )


TIPPING = (
    _tipping(
        "opposite",
        TIPS,
        Hyperparameter("squeeze", "N", 0.0, 500.0, _opposed, "force with which each hand squeezes the box"),
        "two hands on opposite sides tip the box on its edge and hold it there",
    ),
    _tipping(
        "lower",
        LOWERS,
        Hyperparameter("squeeze", "N", 0.0, 500.0, _opposed, "force with which each hand squeezes the box"),
        "two hands below and above lower the box on its next face and hold it",
    ),
    _tipping(
        "adjacent",
        LEANS,
        Hyperparameter("squeeze", "N", 0.0, 500.0, _light, "force with which each hand pushes on its face"),
        "two hands beside the edge tilt the box back until it leans on the other hand",
    ),
)

TILTING = Block(
    name="TILTING",
    slots=(Slot("hand", StaticEndEffector), Slot("object", Tumblable)),
    anchor="object",
    targets=(Target("face", FACE), Target("posture", POSTURES)),
    entry=(
        HOLDS("face", "posture"),
        POSTURE("object", "posture"),
        AT_FACE("hand", "object", "face"),
        STRONG_ENOUGH("hand", "object"),
    ),
    exit=(AT_FACE("hand", "object", "face"), AT_REST("hand")),
    writes={"hand": MOTION},
    # The hands' workspace is not measured in the blocks of tumbling yet.
    keeps=(IN_WORKSPACE,),
    duration=Duration(0.1, 60.0, lambda binding, state, hyperparameters: 0.1),
    hold=True,
    policy=partial(stay, slot="hand"),
    system=hand_system,
    description="one hand holds the tipped box, which leans on it",
)
