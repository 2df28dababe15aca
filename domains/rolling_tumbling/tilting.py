"""TILTING (paper, D3): one hand, on the face over which the box leans, holds it while another one moves."""

from typing import cast

from hybrid_tamp.authoring import (
    Binding,
    Block,
    Commands,
    Duration,
    FloatArray,
    Hyperparameters,
    Policy,
    Slot,
    State,
    Target,
    Token,
)

from ..common.classes import StaticEndEffector
from ..common.predicates import AT_REST
from ..common.servos import force_on, free_motion, position_servo
from .classes import Tumblable
from .faces import FACE, POSTURES
from .predicates import IN_WORKSPACE
from .tumbling_predicates import AT_FACE, HOLDS, POSTURE, STRONG_ENOUGH


def _stay(binding: Binding, start: State, hyperparameters: Hyperparameters) -> Policy:
    hand = cast(Token, binding["hand"])
    place = start[hand, "position"].copy()

    def policy(elapsed: FloatArray, state: State) -> Commands:
        return {(hand.name, "force"): position_servo(hand, state, place)}

    return policy


def _system(binding: Binding, state: State, commands: Commands, dt: float) -> State:
    hand = cast(Token, binding["hand"])
    return free_motion(state, hand, force_on(hand, state, commands), dt)


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
    system=_system,
    description="one hand holds the tipped box, which leans on it",
)
