"""The blocks GRASPING (paper, D7) and RELEASING (D11), in which a hand closes on a handle and opens again."""

import numpy as np

from hybrid_tamp.authoring import (
    FINGER_SPEED,
    FLOOR,
    Binding,
    Block,
    Commands,
    Duration,
    FloatArray,
    Hyperparameter,
    Hyperparameters,
    Measure,
    Parameters,
    Policy,
    Slot,
    State,
    Target,
)
from hybrid_tamp.skills import (
    AT_REST,
    IN_WORKSPACE,
    MOTION,
    Graspable,
    ReachGoal,
    Timetable,
    beside_handle,
    get_token,
    get_tokens,
    gripping_system,
    hand_servo,
    handle_length,
    location_on_handle,
    move_straight,
    on_handle,
    point,
)

from .classes import DexterousHand
from .feasibility import GRASP_FACTS
from .predicates import AT_HANDLE, EMPTY, HELD, STANDS

_APPROACH = 0.8
"""Duration of the hand's movement from its waiting position to the grasp location [s]."""
_CLOSES_AFTER = 0.95
"""Elapsed time at which the hand, which is then at rest, begins to close [s]."""
_OPENING = 0.3
"""Time in which the fingers open before the hand moves away [s]."""
_LEAVING = 0.8
"""Duration of the movement away from the handle [s]."""


def _beside(binding: Binding, state: State) -> FloatArray:
    return beside_handle(state, *get_tokens(binding, "hand", "tool"))


def _middle(binding: Binding, state: State) -> FloatArray:
    return np.asarray(handle_length(get_token(binding, "tool")) / 2)


def _bounds(binding: Binding) -> tuple[float, float]:
    return 0.0, handle_length(get_token(binding, "tool"))


def _grasp_time(binding: Binding, state: State, hyperparameters: Hyperparameters) -> float:
    hand, tool = get_tokens(binding, "hand", "tool")
    return float(_CLOSES_AFTER + (hand["maximal_aperture"] - tool["handle_width"]) / FINGER_SPEED + 0.01)


def _grasp(binding: Binding, start: State, parameters: Parameters) -> Policy:
    hand, tool = get_tokens(binding, "hand", "tool")
    origin = start[hand, "position"].copy()
    way = point(start, tool, on_handle(tool, parameters.hyperparameters["grasp_location"])) - origin
    servo, grip = hand_servo(hand, start), hand["maximal_grip"]
    timetable = Timetable(move_straight(origin, way, _APPROACH), start)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        closing = np.where(elapsed > _CLOSES_AFTER, grip, 0.0)
        gripping = np.broadcast_to(closing[..., None], state[hand, "aperture"].shape)
        return servo(state, *timetable(elapsed)) | {(hand.name, "grip"): gripping}

    return policy


def _contact(binding: Binding, before: State, after: State, hyperparameters: Hyperparameters) -> FloatArray:
    """Return the fraction ``(...)`` of the hand's contact width that touches the handle after the grasp."""
    hand, tool = get_tokens(binding, "hand", "tool")
    place, half = location_on_handle(after, hand, tool), hand["contact_width"] / 2
    touching = np.minimum(place + half, handle_length(tool)) - np.maximum(place - half, 0.0)
    return np.asarray(np.clip(touching / hand["contact_width"], 0.0, 1.0))


def _grasped(binding: Binding, state: State) -> State:
    """Return the state with the hand closed at the middle of the handle."""
    hand, tool = get_tokens(binding, "hand", "tool")
    place = point(state, tool, on_handle(tool, handle_length(tool) / 2))
    return state.replace({(hand.name, "position"): place, (hand.name, "aperture"): tool["handle_width"]})


def _release(binding: Binding, start: State, parameters: Parameters) -> Policy:
    hand, tool = get_tokens(binding, "hand", "tool")
    origin = start[hand, "position"].copy()
    servo = hand_servo(hand, start)
    timetable = Timetable(move_straight(origin, beside_handle(start, hand, tool) - origin, _LEAVING, _OPENING), start)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        return servo(state, *timetable(elapsed))

    return policy


def _released(binding: Binding, state: State) -> State:
    hand, tool = get_tokens(binding, "hand", "tool")
    place = beside_handle(state, hand, tool)
    return state.replace({(hand.name, "position"): place, (hand.name, "aperture"): hand["maximal_aperture"]})


_GRASPABLE = tuple(fact("hand", "tool") for fact in GRASP_FACTS)
REACH_HANDLE = ReachGoal(
    targets=(Target("tool", Graspable),),
    position=_beside,
    entry=(*_GRASPABLE, EMPTY("hand"), STANDS("tool"), AT_REST("tool")),
    arrived=(AT_HANDLE("hand", "tool"),),
    lasting=(EMPTY("hand"), STANDS("tool"), AT_REST("tool")),
    hand_class=DexterousHand,
    # Only an empty hand can reach, so no hand leaves a tool behind.
    keeps=(HELD,),
)

GRASPING = Block(
    name="GRASPING",
    slots=(Slot("hand", DexterousHand), Slot("tool", Graspable)),
    anchor="hand",
    entry=(*_GRASPABLE, AT_HANDLE("hand", "tool"), EMPTY("hand"), STANDS("tool"), AT_REST("tool")),
    exit=(HELD("tool", "hand"), ~EMPTY("hand"), AT_REST("hand")),
    invariants=(IN_WORKSPACE("hand"), STANDS("tool")),
    waived={AT_REST("tool"): "the fingers may shake the tool when they close"},
    writes={"hand": (*MOTION, "aperture")},
    allowed_contacts=(("hand", "tool"), ("tool", FLOOR)),
    hyperparameters=(
        Hyperparameter(
            "grasp_location",
            "m",
            0.0,
            100.0,
            _middle,
            "distance of the grasp from handle_to, along the handle",
            _bounds,
        ),
    ),
    duration=Duration(_APPROACH, 5.0, _grasp_time),
    hold=True,
    policy=_grasp,
    system=gripping_system("tool"),
    performance=(
        Measure("contact", "1", 1.0, end=_contact, description="fraction of contact_width that touches the handle"),
    ),
    outcome=_grasped,
    description="the hand moves to the grasp location and closes on the handle",
)

RELEASING = Block(
    name="RELEASING",
    slots=(Slot("hand", DexterousHand), Slot("tool", Graspable)),
    anchor="hand",
    entry=(HELD("tool", "hand"), STANDS("tool")),
    # The exit requires STANDS, because the tool must not fall over when the hand opens.
    exit=(~HELD("tool", "hand"), EMPTY("hand"), STANDS("tool"), AT_REST("hand"), AT_REST("tool")),
    invariants=(IN_WORKSPACE("hand"), STANDS("tool")),
    writes={"hand": (*MOTION, "aperture")},
    allowed_contacts=(("hand", "tool"), ("tool", FLOOR)),
    duration=Duration(_OPENING + _LEAVING, 5.0, lambda binding, state, hyperparameters: _OPENING + _LEAVING + 0.05),
    policy=_release,
    system=gripping_system("tool"),
    outcome=_released,
    description="the hand opens and moves away, and the tool remains standing",
)
