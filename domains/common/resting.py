"""RESTING (paper, D6): whatever nothing manipulates."""

from typing import cast

from hybrid_tamp.authoring import (
    TOKEN,
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

from .predicates import AT_REST
from .servos import hand_servo


def _stay(binding: Binding, start: State, parameters: Parameters) -> Policy:
    """Hold a hand where it was; other tokens take no commands."""
    token = cast(Token, binding["token"])
    place = start[token, "position"].copy()

    servo = hand_servo(token, start)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        return servo(state, place, 0.0)

    return policy


RESTING = Block(
    name="RESTING",
    slots=(Slot("token", TOKEN),),
    anchor="token",
    entry=(AT_REST("token"),),
    duration=Duration(0.1, 3600.0, lambda binding, state, hyperparameters: 0.1),
    hold=True,
    policy=_stay,
    description="nothing manipulates the token; a hand stays where it is",
)
