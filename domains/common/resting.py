"""RESTING (paper, D6): no block manipulates the token."""

from hybrid_tamp.authoring import TOKEN, Binding, Block, Commands, Duration, FloatArray, Parameters, Policy, Slot, State

from .predicates import AT_REST
from .roles import get_token
from .servos import hand_servo


def stay(binding: Binding, start: State, parameters: Parameters, slot: str = "token") -> Policy:
    """Make the policy that holds a hand where it starts; a token without basic actions gets no commands."""
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
    duration=Duration(0.1, 3600.0, lambda binding, state, hyperparameters: 0.1),
    hold=True,
    policy=stay,
    description="nothing manipulates the token; a hand stays where it is",
)
