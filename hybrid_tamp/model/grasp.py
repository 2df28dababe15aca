"""Grasping: hands that can grip, objects that can be gripped, constants of the fingers, and the limits of a grip.

A hand that can grip has two virtual, massless fingers, one on each side of its centre. The fingers close on a handle
within reach and hold the handle only by friction and squeeze. The fingers mirror each other, so the sum of their normal
forces is twice the grip force N, whatever the load. The pads have the length w along the handle and close along the
body's z axis. In the frame with x along the handle and z along the closing direction, a grip bears (`grip_limits`):

- friction of both pads: 2 mu N along and across the handle, in the plane of the pads;
- torque about z, by friction of two line contacts with uniform pressure: 2 mu N w/4, as the integral of
  ``mu N |s| / w`` from -w/2 to w/2 is mu N w/4 for one pad;
- torque about the handle, by opposite friction on two pads that are the handle's width h apart: mu N h;
- force along z: 2 N, at which one finger bears everything;
- torque about y: N w, at which the pressure of each pad has shifted to an end of the pad.

Friction obeys an ellipsoid over its four components (`motion.limit_surface`).
"""

import numpy as np

from hybrid_tamp.model.affordance import VaryingProperty
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.poses import cross, normalized

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
PAD_FRICTION = 0.5
"""Default friction coefficient of the fingers' pads (property `pad_friction` of a hand)."""
HANDLE_FRICTION = 1.0
"""Default friction coefficient of a handle (property `handle_friction`). Both coefficients multiply."""
PAD_LENGTH = 0.06
"""Default length of the pads along a handle [m] (property `contact_width` of a hand)."""
_SMALLEST = 1e-9
"""Smallest limit of a grip [N, N m]. It keeps the limit surface of a smooth handle regular."""


def grip_friction(hand: Token, thing: Token) -> float:
    """Return the friction coefficient between a hand's pads and the handle of an object."""
    pad, handle = (
        float(token.properties.get(name, default))
        for token, name, default in (
            (hand, "pad_friction", PAD_FRICTION),
            (thing, "handle_friction", HANDLE_FRICTION),
        )
    )
    return pad * handle


def grip_limits(hand: Token, thing: Token, force: float) -> FloatArray:
    """Return the largest forces [N] and torques [N m], shape ``(6,)``, that a grip bears along and about its axes.

    Args:
        hand: hand that grips.
        thing: object with a handle.
        force: force of each finger [N].
    """
    pad = float(hand.properties.get("contact_width", PAD_LENGTH))
    rubbing = grip_friction(hand, thing) * force
    limits = (
        2.0 * rubbing,
        2.0 * rubbing,
        2.0 * force,
        rubbing * thing["handle_width"],
        force * pad,
        rubbing * pad / 2.0,
    )
    return np.maximum(limits, _SMALLEST)


def grip_axes(thing: Token) -> FloatArray:
    """Return the axes of a grip as the rows of a rotation matrix ``(3, 3)``, in the body frame of the object.

    The x axis points along the handle. The fingers close along z, which is perpendicular to the handle and nearest to
    the z axis of the body. If the handle is nearly parallel to this axis, z is nearest to the x axis of the body.
    """
    along = normalized(np.subtract(thing["handle_to"], thing["handle_from"]))
    upright = np.array([0.0, 0.0, 1.0]) if abs(along[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
    closing = normalized(upright - along * (upright @ along))
    return np.stack([along, cross(closing, along), closing])


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
