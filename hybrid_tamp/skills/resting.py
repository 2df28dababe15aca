"""The block RESTING (paper, D6) of a token that no other block manipulates."""

from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.block import FLOOR, Block, Duration, Slot
from hybrid_tamp.model.control import Commands, Parameters, Policy
from hybrid_tamp.model.predicate import Binding
from hybrid_tamp.model.state import State
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.skills.predicates import AT_REST
from hybrid_tamp.skills.roles import get_token
from hybrid_tamp.skills.servos import hand_servo


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
