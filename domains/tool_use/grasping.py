"""GRASPING (paper, D7): a hand reaches from beside a handle to the grasp location and closes."""

from typing import cast

import numpy as np

from hybrid_tamp.authoring import (
    FINGER_SPEED,
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
    Token,
)

from ..common.predicates import AT_REST
from ..common.primitives import straight_profile
from ..common.reaching import ReachGoal
from ..common.servos import hand_servo
from ..common.timetable import Timetable
from .classes import DexterousHand, Graspable
from .feasibility import GRASP_FACTS
from .geometry import beside, handle_length, location, on_handle, point
from .holding import gripping_system
from .predicates import AT_HANDLE, EMPTY, HELD, STANDS

_APPROACH = 0.8
"""How long the hand takes from beside the handle to the grasp location [s]."""
_CLOSES_AFTER = 0.95
"""When it begins to close [s]: it is at rest by then."""


def _roles(binding: Binding) -> tuple[Token, Token]:
    return cast(Token, binding["hand"]), cast(Token, binding["tool"])


def _beside(binding: Binding, state: State) -> FloatArray:
    return beside(state, *_roles(binding))


def _middle(binding: Binding, state: State) -> FloatArray:
    return np.asarray(handle_length(cast(Token, binding["tool"])) / 2)


def _bounds(binding: Binding) -> tuple[float, float]:
    return 0.0, handle_length(cast(Token, binding["tool"]))


def _expected(binding: Binding, state: State, hyperparameters: Hyperparameters) -> float:
    hand, tool = _roles(binding)
    return float(_CLOSES_AFTER + (hand["maximal_aperture"] - tool["handle_width"]) / FINGER_SPEED + 0.01)


def _policy(binding: Binding, start: State, parameters: Parameters) -> Policy:
    hand, tool = _roles(binding)
    origin = start[hand, "position"].copy()
    whole = point(start, tool, on_handle(tool, parameters.hyperparameters["grasp_location"])) - origin
    profile, servo, grip = straight_profile(), hand_servo(hand, start), hand["maximal_grip"]

    def approach(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        done = profile.share(elapsed / _APPROACH)[..., None]
        speed = profile.rate(elapsed / _APPROACH)[..., None] / _APPROACH
        return origin + done * whole, speed * whole

    timetable = Timetable(approach, start)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        closing = np.where(elapsed > _CLOSES_AFTER, grip, 0.0)
        gripping = np.broadcast_to(closing[..., None], state[hand, "aperture"].shape)
        return servo(state, *timetable(elapsed)) | {(hand.name, "grip"): gripping}

    return policy


def _contact(binding: Binding, before: State, after: State, hyperparameters: Hyperparameters) -> FloatArray:
    """Return which share of the hand's width touches the handle ``(...)``, by where it is in the end."""
    hand, tool = _roles(binding)
    place, half = location(after, hand, tool), hand["contact_width"] / 2
    touching = np.minimum(place + half, handle_length(tool)) - np.maximum(place - half, 0.0)
    return np.asarray(np.clip(touching / hand["contact_width"], 0.0, 1.0))


def _outcome(binding: Binding, state: State) -> State:
    """The hand is at the middle of the handle, closed."""
    hand, tool = _roles(binding)
    place = point(state, tool, on_handle(tool, handle_length(tool) / 2))
    return state.replace({(hand.name, "position"): place, (hand.name, "aperture"): tool["handle_width"]})


REACH_HANDLE = ReachGoal(
    targets=(Target("tool", Graspable),),
    position=_beside,
    entry=(*(fact("hand", "tool") for fact in GRASP_FACTS), EMPTY("hand"), STANDS("tool"), AT_REST("tool")),
    arrived=(AT_HANDLE("hand", "tool"),),
    hand_class=DexterousHand,
    # Only an empty hand reaches, so that it leaves nothing behind.
    keeps=(HELD,),
)

GRASPING = Block(
    name="GRASPING",
    slots=(Slot("hand", DexterousHand), Slot("tool", Graspable)),
    anchor="hand",
    entry=(
        *(fact("hand", "tool") for fact in GRASP_FACTS),
        AT_HANDLE("hand", "tool"),
        EMPTY("hand"),
        STANDS("tool"),
        AT_REST("tool"),
    ),
    exit=(HELD("tool", "hand"), ~EMPTY("hand"), AT_REST("hand")),
    writes={"hand": ("position", "velocity", "aperture")},
    hyperparameters=(
        Hyperparameter(
            "grasp_location",
            "m",
            0.0,
            100.0,
            _middle,
            "distance of the grasp from the end of the handle near the head",
            _bounds,
        ),
    ),
    duration=Duration(_APPROACH, 5.0, _expected),
    hold=True,
    policy=_policy,
    system=gripping_system,
    performance=(
        Measure("contact", "1", 1.0, end=_contact, description="share of the hand's width that touches the handle"),
    ),
    outcome=_outcome,
    description="the hand reaches to the grasp location and closes on the handle",
)
