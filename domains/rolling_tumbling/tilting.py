"""TILTING (paper, D3): one hand, on the face over which the box leans, holds it while another one moves."""

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
    Target,
    Token,
)

from ..common.classes import StaticEndEffector
from ..common.predicates import AT_REST
from ..common.servos import hand_system, position_servo
from .classes import Tumblable
from .faces import FACE, POSTURES
from .predicates import IN_WORKSPACE
from .tumbling_predicates import AT_FACE, HOLDS, POSTURE, STRONG_ENOUGH


def _stay(binding: Binding, start: State, parameters: Parameters) -> Policy:
    hand = cast(Token, binding["hand"])
    place, servo = start[hand, "position"].copy(), position_servo(hand)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        return {(hand.name, "force"): servo(state, place)}

    return policy


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
    writes={"hand": ("position", "velocity")},
    # The hands' workspace is not measured in the blocks of tumbling yet.
    keeps=(IN_WORKSPACE,),
    duration=Duration(0.1, 60.0, lambda binding, state, hyperparameters: 0.1),
    hold=True,
    policy=_stay,
    system=hand_system,
    description="one hand holds the tipped box, which leans on it",
)
