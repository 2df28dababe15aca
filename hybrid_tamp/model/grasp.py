"""Grasping: hands that can grip, objects that can be gripped, and constants of the fingers.

A hand that can grip has two virtual, massless fingers, one on each side of its centre. The fingers close on a handle
within reach and hold the handle only by friction.
"""

from hybrid_tamp.model.affordance import VaryingProperty
from hybrid_tamp.model.token import Token

GRIP = "grip"
"""Name of the fingers' basic action. Positive commands are closing forces [N]. Other commands open the fingers."""
APERTURE = "aperture"
"""Name of the varying property for the gap between the fingers [m]."""
HANDLE = ("handle_from", "handle_to", "handle_width")
"""Names of a handle's fixed properties: the positions of both ends in the body frame [m], and the width [m]."""
FINGER_SPEED = 0.25
"""Speed at which the gap between the fingers changes [m/s]."""
CAPTURE = 0.01
"""Largest distance from the centre of a hand to the axis of a handle at which the hand can grip the handle [m]."""
GRIP_FRICTION = 1.0
"""Ratio of the largest friction force of both fingers to the grip force. Each finger has a friction coefficient of 0.5.
"""


def aperture_property(opened: float) -> VaryingProperty:
    """Return the varying property `aperture` of a hand whose fingers have the initial gap `opened` [m]."""
    return VaryingProperty(APERTURE, 1, "m", (opened,), "gap between the two virtual fingers")


def grips(token: Token) -> bool:
    """Return whether the token is a hand with fingers."""
    return any(action.name == GRIP for action in token.basic_actions)


def can_be_gripped(token: Token) -> bool:
    """Return whether the token has a handle."""
    return all(name in token.properties for name in HANDLE)


def pass_through(one: Token, other: Token) -> bool:
    """Return whether the tokens pass through each other. Only a hand with fingers and a token with a handle do so."""
    return (grips(one) and can_be_gripped(other)) or (grips(other) and can_be_gripped(one))
