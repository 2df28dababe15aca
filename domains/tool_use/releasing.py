"""RELEASING (paper, D11): a hand opens and leaves the tool sideways."""

from typing import cast

from hybrid_tamp.authoring import (
    Binding,
    Block,
    Commands,
    Duration,
    FloatArray,
    Parameters,
    Policy,
    Slot,
    State,
    Token,
)

from ..common.predicates import AT_REST
from ..common.primitives import straight_profile
from ..common.servos import hand_servo
from ..common.timetable import Timetable
from .classes import DexterousHand, Graspable
from .geometry import beside
from .holding import gripping_system
from .predicates import EMPTY, HELD, STANDS

_OPENING = 0.3
"""How long the fingers have to open before the hand moves [s]."""
_LEAVING = 0.8
"""How long the hand takes to leave [s]."""


def _roles(binding: Binding) -> tuple[Token, Token]:
    return cast(Token, binding["hand"]), cast(Token, binding["tool"])


def _policy(binding: Binding, start: State, parameters: Parameters) -> Policy:
    hand, tool = _roles(binding)
    origin = start[hand, "position"].copy()
    whole = beside(start, hand, tool) - origin
    profile = straight_profile()
    servo = hand_servo(hand, start)

    def leaving(elapsed: FloatArray) -> tuple[FloatArray, ...]:
        phase = (elapsed - _OPENING) / _LEAVING
        done, speed = profile.share(phase)[..., None], profile.rate(phase)[..., None] / _LEAVING
        return origin + done * whole, speed * whole

    timetable = Timetable(leaving, start)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        return servo(state, *timetable(elapsed))

    return policy


def _outcome(binding: Binding, state: State) -> State:
    hand, tool = _roles(binding)
    place = beside(state, hand, tool)
    return state.replace({(hand.name, "position"): place, (hand.name, "aperture"): hand["maximal_aperture"]})


RELEASING = Block(
    name="RELEASING",
    slots=(Slot("hand", DexterousHand), Slot("tool", Graspable)),
    anchor="hand",
    entry=(HELD("tool", "hand"), STANDS("tool")),
    # What is let go must go on standing: the condition is measured.
    exit=(~HELD("tool", "hand"), EMPTY("hand"), STANDS("tool"), AT_REST("hand"), AT_REST("tool")),
    writes={"hand": ("position", "velocity", "aperture")},
    duration=Duration(_OPENING + _LEAVING, 5.0, lambda binding, state, hyperparameters: _OPENING + _LEAVING + 0.05),
    policy=_policy,
    system=gripping_system,
    outcome=_outcome,
    description="the hand opens and leaves the tool where it stands",
)
