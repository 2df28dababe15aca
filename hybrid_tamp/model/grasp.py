"""What grasping means to all who ask: which tokens grip, which can be gripped, and the constants of the fingers.

A hand that grips has two virtual fingers, massless, on either side of its centre. They close on the handle of what
they can reach, and hold it by friction only.
"""

from hybrid_tamp.model.affordance import VaryingProperty
from hybrid_tamp.model.token import Token

GRIP = "grip"
"""The basic action that closes the fingers with a force if positive [N], and opens them otherwise."""
APERTURE = "aperture"
"""The varying property that tells the gap between the fingers [m]."""
HANDLE = ("handle_from", "handle_to", "handle_width")
"""The fixed properties of what can be gripped: the ends of its handle in the body frame and its width [m]."""
FINGER_SPEED = 0.25
"""How fast the gap between the fingers changes [m/s]."""
CAPTURE = 0.01
"""Largest distance from the hand's centre to the axis of a handle that the fingers close on [m]."""
GRIP_FRICTION = 1.0
"""Largest friction of both fingers together as a share of the grip force: two fingers of friction .5."""


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
    """Say whether two tokens do not collide: open fingers pass round what can be gripped."""
    return (grips(one) and can_be_gripped(other)) or (grips(other) and can_be_gripped(one))
