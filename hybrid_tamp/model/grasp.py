"""Grasping: which tokens grip, which can be gripped, and the constants of the fingers.

A hand that grips has two virtual, massless fingers, one on either side of its centre. They close on a handle within
reach and hold it by friction only.
"""

from hybrid_tamp.model.affordance import VaryingProperty
from hybrid_tamp.model.token import Token

GRIP = "grip"
"""The basic action that closes the fingers with a force if positive [N], and opens them otherwise."""
APERTURE = "aperture"
"""The varying property for the gap between the fingers [m]."""
HANDLE = ("handle_from", "handle_to", "handle_width")
"""The fixed properties of a handle: its ends in the body frame and its width [m]."""
FINGER_SPEED = 0.25
"""Speed at which the gap between the fingers changes [m/s]."""
CAPTURE = 0.01
"""Largest distance from the centre of the hand to the axis of a handle that it can grip [m]."""
GRIP_FRICTION = 1.0
"""Largest friction of both fingers together as a share of the grip force: two fingers of friction 0.5."""


def aperture_property(opened: float) -> VaryingProperty:
    """Return the varying property `aperture` of a hand whose fingers start with this gap [m]."""
    return VaryingProperty(APERTURE, 1, "m", (opened,), "gap between the two virtual fingers")


def grips(token: Token) -> bool:
    """Say whether the token is a hand with fingers."""
    return any(action.name == GRIP for action in token.basic_actions)


def can_be_gripped(token: Token) -> bool:
    """Say whether the token has a handle."""
    return all(name in token.properties for name in HANDLE)


def pass_through(one: Token, other: Token) -> bool:
    """Say whether two tokens do not collide, because open fingers pass round a handle."""
    return (grips(one) and can_be_gripped(other)) or (grips(other) and can_be_gripped(one))
