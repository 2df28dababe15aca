"""The block RESTING (paper, D6) of a token that no other block manipulates."""

from hybrid_tamp.authoring import (
    FLOOR,
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
)

from .predicates import AT_REST
from .roles import get_token
from .servos import hand_servo


def stay(binding: Binding, start: State, parameters: Parameters, slot: str = "token") -> Policy:
    """Return the policy that keeps a hand in place. A token without basic actions receives no commands."""
    token = get_token(binding, slot)
    place, servo = start[token, "position"].copy(), hand_servo(token, start)

    def policy(elapsed: FloatArray, state: State) -> Commands:
        return servo(state, place, 0.0)

    return policy


RESTING = Block(
    name="RESTING",
    slots=(Slot("token", TOKEN),),
    anchor="token",
    entry=(AT_REST("token"),),
    waived={AT_REST("token"): "a resting token may be touched, and the contact limit of the task bounds the force"},
    # Tokens may rest on each other.
    allowed_contacts=(("token", FLOOR), ("token", "token")),
    duration=Duration(0.1, 3600.0, lambda binding, state, hyperparameters: 0.1),
    hold=True,
    policy=stay,
    description="no other block manipulates the token; if the token is a hand, the hand keeps its position",
)
