"""The blocks TIPPING and TILTING, which tumble a box (paper, D2 to D4).

In TIPPING, two hands turn a box about one of its edges. TIPPING has three modes:

- ``opposite`` (D2): hands on opposite sides tip a flat box over an edge, past its point of balance.
- ``lower`` (D2 with another outcome): hands below and above the box lower the box onto its next face.
- ``adjacent`` (D4): hands on the two faces beside the edge tilt the box back until it leans over the other face.

In TILTING (D3), the box leans over a face, and a single hand on this face holds the box. Other hands are free to move.
"""

from functools import partial

import numpy as np

from hybrid_tamp.authoring import (
    DMP,
    FLOOR,
    GRAVITY,
    Binding,
    Block,
    Course,
    Duration,
    FloatArray,
    Hyperparameter,
    Literal,
    Movement,
    Parameters,
    Policy,
    Predicate,
    Slot,
    State,
    Target,
    cross,
)
from hybrid_tamp.skills import (
    AT_REST,
    BODY,
    FREE_TO_MOVE,
    IN_WORKSPACE,
    UP,
    Pressure,
    StaticEndEffector,
    conditions,
    dot,
    get_symbol,
    get_token,
    get_tokens,
    hand_system,
    make_pressing,
    normal,
    press,
    profile_of,
    squeezing,
)

from .classes import Tumblable
from .control_predicates import ABLE_HAND, CLEAR_OF_FLOOR, HEAVY_ENOUGH, TURNS_SLOWLY
from .faces import FACE, POSTURES, faces_of
from .predicates import INSIDE, LIES_ON_SIDE, ON_ROLLING_LINE, WITHIN_WORKSPACE
from .sliding import squeeze_range
from .tumbling_geometry import edge_axis, edge_position
from .tumbling_predicates import AT_FACE, HOLDS, LANDS, LEANS, LOWERS, POSTURE, STRONG_ENOUGH, TIPS
from .turning import CLOSING, after_turning, keep_parallel, make_turning, poses_of_turn, sweep_turning
from .turning_model import turning_system

_LEAN_SQUEEZE = 25.0
"""Largest default squeeze [N] of hands that tilt a box from one hand over to the other hand."""
_MOST = 500.0
"""Largest squeeze [N] of these hands."""
_LIGHT_SQUEEZE = 0.25
"""Ratio of this squeeze to the weight of a light box, which a larger squeeze would throw when a hand lets go."""
_AT_FACES = (AT_FACE("first", "object", "near"), AT_FACE("second", "object", "far"))
_ABLE = (
    *conditions(ABLE_HAND, hand="first"),
    *conditions(ABLE_HAND, hand="second"),
    HEAVY_ENOUGH("object"),
    FREE_TO_MOVE("object"),
)


def _squeezes(binding: Binding) -> tuple[float, float, float]:
    """Return the smallest, ideal and largest squeeze [N] to tip the flat box, or to lower the box until it is flat."""
    first, second, thing = get_tokens(binding, "first", "second", "object")
    postures = (faces_of(get_symbol(binding, role)) for role in ("before", "outcome"))
    (down,) = next(faces for faces in postures if len(faces) == 1)
    force = min(first["maximal_force"], second["maximal_force"])
    return squeeze_range(thing, get_symbol(binding, "near"), down, float(force))


def _light(binding: Binding) -> tuple[float, float, float]:
    """Return the smallest, usual and largest squeeze [N] to tilt the box from one hand over to the other hand."""
    return 0.0, min(_LEAN_SQUEEZE, _LIGHT_SQUEEZE * GRAVITY * get_token(binding, "object")["mass"]), _MOST


def _hold(binding: Binding, start: State, parameters: Parameters) -> Policy:
    """Return the policy of a hand that stays in place and bears the box, which leans on the hand."""
    hand, thing = get_tokens(binding, "hand", "object")
    face, edge = get_symbol(binding, "face"), faces_of(get_symbol(binding, "posture"))
    weight, still = -GRAVITY * thing["mass"] * UP, np.asarray(0.0)

    def plan(elapsed: FloatArray, state: State) -> Pressure:
        pivot, axis = edge_position(state, thing, *edge), edge_axis(state, thing, *edge)
        moment = dot(cross(state[thing, "position"] - pivot, weight), axis)
        outward = normal(state, thing, face)
        arm = dot(cross(state[hand, "position"] - pivot, outward), axis)
        # Without this force, the hand would sink until its servo bears the box.
        push = -outward * (np.maximum(moment, 0.0) / np.maximum(np.abs(arm), 1e-3))[..., None]
        return Pressure(still, still, still, pivot=np.zeros(3), bearing=push)

    return keep_parallel(press([(hand, face)], thing, start, [still], still, plan), [(hand, face)], thing, start)


def _tipping(
    mode: str,
    relation: Predicate,
    squeeze: Hyperparameter,
    description: str,
    feasible: tuple[Literal, ...] = (),
    primitive: DMP | None = None,
) -> Block:
    """Return one mode of TIPPING, with further feasibility conditions.

    The primitive, by default `straight_movement`, generates the tilt of the box.
    """
    return make_pressing(
        f"TIPPING:{mode}",
        ("first", "second"),
        Tumblable,
        targets=(Target("near", FACE), Target("far", FACE), Target("before", POSTURES), Target("outcome", POSTURES)),
        entry=(*conditions((relation, POSTURE), posture="before"), *_AT_FACES, *_ABLE, *feasible),
        exit=(POSTURE("object", "outcome"), *_AT_FACES),
        always=(IN_WORKSPACE, CLEAR_OF_FLOOR),
        invariants=(TURNS_SLOWLY("object"),),
        # Boxes do not roll, so the facts of rolling do not change.
        keeps=(INSIDE, LIES_ON_SIDE, ON_ROLLING_LINE, WITHIN_WORKSPACE),
        ends={"object": ("near", "far", "before", "outcome")},
        hyperparameters=(
            Hyperparameter("rate", "rad/s", 0.1, 1.0, lambda b, s: np.asarray(0.5), "mean angular speed of the turn"),
            squeeze,
        ),
        duration=Duration(CLOSING, 20.0),
        hold=True,
        policy=partial(make_turning, profile=profile_of(primitive)),
        sweep=partial(sweep_turning, profile=profile_of(primitive)),
        system=turning_system,
        taught=partial(_tipping, mode, relation, squeeze, description, feasible),
        movement=Movement("object", "orientation", 1),
        key_poses=poses_of_turn,
        outcome=after_turning,
        description=description,
    )


TIPPING = (
    _tipping(
        "opposite",
        TIPS,
        squeezing(_squeezes),
        "two hands on opposite sides tip the box onto an edge and hold the box there",
        # The first turn of a tumble decides where the box will lie.
        (LANDS("object", "far"),),
    ),
    _tipping(
        "lower",
        LOWERS,
        squeezing(_squeezes),
        "two hands, one below and one above the box, lower the box onto its next face and hold the box",
    ),
    _tipping(
        "adjacent",
        LEANS,
        squeezing(_light, _MOST),
        "two hands on the faces beside the edge tilt the box from one hand over to the other hand",
    ),
)

TILTING = Block(
    name="TILTING",
    slots=(Slot("hand", StaticEndEffector), Slot("object", Tumblable)),
    anchor="object",
    targets=(Target("face", FACE), Target("posture", POSTURES)),
    entry=conditions((HOLDS, POSTURE, AT_FACE, STRONG_ENOUGH)),
    exit=(*conditions((AT_FACE,)), AT_REST("hand")),
    invariants=conditions((IN_WORKSPACE, CLEAR_OF_FLOOR, POSTURE, TURNS_SLOWLY)),
    writes={"hand": BODY},
    allowed_contacts=(("hand", "object"), ("object", FLOOR)),
    duration=Duration(0.1, 60.0),
    hold=True,
    policy=_hold,
    sweep=lambda binding, start, parameters: Course(start.repeated(1)),
    system=hand_system,
    description="one hand holds the tipped box, which leans on this hand",
)
