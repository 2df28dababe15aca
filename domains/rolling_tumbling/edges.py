"""What a turn about an edge of a box requires: strength, friction, a low box, and room for a hand below the box.

An edge is parallel to a body axis of the box, given by its index. All figures are for turns about all four edges that
are parallel to the axis.
"""

import numpy as np

from hybrid_tamp.authoring import DEFAULT_FRICTION, GRAVITY, Token
from hybrid_tamp.skills import NORMALS

from .faces import faces_of
from .sliding import friction_needed, leaning_friction
from .standing import SLENDERNESS
from .tumbling_geometry import GRIP, room_below, sections

_FRICTIONLESS = 1e-6
"""Friction of the ground below which a smaller friction makes no difference."""


def axis_of(face: str, posture: str) -> int:
    """Return the index of the body axis about which a hand at a face turns a box in a posture."""
    one, other = (face, *faces_of(posture)) if len(faces_of(posture)) == 1 else faces_of(posture)
    return int(np.argmin(np.abs(NORMALS[one]) + np.abs(NORMALS[other])))


def strength_needed(thing: Token, axis: int) -> float:
    """Return the smallest force [N] with which a hand can tumble the box about a body axis, without any reserve.

    A box of weight W lies on a side of width w. A hand presses on a face at height h with the normal force N. Its
    friction lifts the far end of the side with the force t N, where t is at most the friction coefficient. The moments
    about the edge balance if N (h + t w) = W w/2. The force of the hand is N sqrt(1 + t^2), which decreases up to
    t = w/h. The second hand can only resist. The force is largest if the box lies on its long side, with h = GRIP times
    the short side. In this position, hands begin a tumble or end a controlled one.
    """
    short, long = sorted(sections(thing, axis))
    height = GRIP * short
    lift = min(DEFAULT_FRICTION * thing["friction"], long / height)
    arm = (height + lift * long) / np.hypot(1.0, lift)
    return float(thing["mass"] * GRAVITY * long / 2.0 / arm)


def friction_left(hand: Token, thing: Token, axis: int) -> float:
    """Return the friction of a box minus the friction needed, if the box lies on its longer side or leans on a hand.

    If the hand is too weak even for a rough box, STRONG_ENOUGH states this reason, and friction is not to blame.
    """
    short, long = sorted(sections(thing, axis))
    force = max(float(hand["maximal_force"]), strength_needed(thing, axis))
    ground = max(thing.ground.friction, _FRICTIONLESS)
    turning = friction_needed(GRAVITY * thing["mass"], long, GRIP * short, force, ground)
    needed = max(turning, leaning_friction(short, long) / ground, leaning_friction(long, short) / ground)
    return float(thing["friction"] - needed)


def lowness(thing: Token, axis: int) -> float:
    """Return the largest ratio of edges that hands can tumble, minus the ratio of the edges around a body axis."""
    short, long = sorted(sections(thing, axis))
    return float(SLENDERNESS - long / short)


def room(hand: Token, thing: Token, axis: int) -> float:
    """Return the smaller room [m] for the hand below the box, for a box that leans over either of its sides."""
    one, other = sections(thing, axis)
    return min(room_below(hand, one, other), room_below(hand, other, one))


def ability(hand: Token, thing: Token, axis: int) -> float:
    """Return a dimensionless margin that is positive if a hand is able to turn a box about a body axis."""
    strength = float(hand["maximal_force"]) / strength_needed(thing, axis) - 1.0
    return min(strength, friction_left(hand, thing, axis), lowness(thing, axis), room(hand, thing, axis) / 0.1)
