"""Forces with which two hands turn a box about its edge without letting the edge slide, in closed form.

A box of weight W lies on a side of width L. Two hands press on opposite faces at height h: one with the force S + D/2
and the other with S - D/2, where S is the squeeze. Let mu be the friction coefficient of the ground and the box, and nu
that of the hands and the box. The friction of the hands lifts the far end of the box with the force nu (S + D/2), and
presses the edge onto the ground with the force nu (S - D/2). The moments about the edge balance if
D (h + nu L/2) = L (W/2 - nu S). The edge does not slide if D <= mu (W - nu D), i.e. D <= mu W/(1 + mu nu). The same
equations hold while hands tip the box, and while hands lower the box onto the side.
"""

import numpy as np

from hybrid_tamp.authoring import DEFAULT_FRICTION, FLOOR_FRICTION, GRAVITY, Token
from hybrid_tamp.skills import half_extent

from .tumbling_geometry import GRIP, PAST_BALANCE, SAG

SQUEEZE = 0.5
"""Smallest squeeze, as a fraction of the weight of the box. Hands that are too weak for this squeeze press less."""
STEADY = 0.75
"""Smallest ratio of the squeeze to the ideal squeeze with which tumbles in physics were controlled."""
_STEPS = 60


def squeeze_needed(
    weight: float, width: float, height: float, friction: float, ground: float = FLOOR_FRICTION
) -> float:
    """Return the smallest squeeze [N] with which the edge does not slide, or infinity without friction.

    Args:
        weight: weight of the box [N].
        width: width of the side on which the box lies [m].
        height: height of the hands above the ground [m].
        friction: friction coefficient of the box.
        ground: friction coefficient of the surface on which the box lies.
    """
    return max(_squeeze_of_edge(weight, width, height, friction, ground), SQUEEZE * weight)


def _squeeze_of_edge(weight: float, width: float, height: float, friction: float, ground: float) -> float:
    floor, hand = ground * friction, DEFAULT_FRICTION * friction
    if hand == 0.0:
        return float("inf")
    most = floor * weight / (1.0 + floor * hand)
    return (weight * width / 2.0 - most * (height + hand * width / 2.0)) / (hand * width)


def _squeeze_of_contact(weight: float, width: float, height: float, friction: float) -> float:
    """Return the squeeze [N] S = D/2 with which the hand that presses less just touches the box."""
    return weight * width / (4.0 * (height + DEFAULT_FRICTION * friction * width))


def press(weight: float, width: float, height: float, friction: float, squeeze: float) -> float:
    """Return the force [N] of the hand that presses harder. See `squeeze_needed` for the arguments."""
    hand = DEFAULT_FRICTION * friction
    if not np.isfinite(squeeze):
        return float("inf")
    difference = width * (weight / 2.0 - hand * squeeze) / (height + hand * width / 2.0)
    return squeeze + max(difference, 0.0) / 2.0


def friction_needed(weight: float, width: float, height: float, force: float, ground: float = FLOOR_FRICTION) -> float:
    """Return the smallest friction of a box that hands of a maximal force [N] turn with `STEADY` of the ideal squeeze.

    The result is at most 5, the largest coefficient of a task.
    """
    low, high = 0.0, 5.0
    for _ in range(_STEPS):
        middle = (low + high) / 2.0
        case = (weight, width, height, middle)
        squeeze = max(STEADY * _squeeze_of_edge(*case, ground), _squeeze_of_contact(*case))
        enough = press(weight, width, height, middle, squeeze) <= force
        low, high = (low, middle) if enough else (middle, high)
    return high


def squeeze_range(thing: Token, near: str, down: str, force: float) -> tuple[float, float, float]:
    """Return the smallest, the ideal and the largest squeeze [N] of a box that lies on a face, or will lie on a face.

    The smallest squeeze is `STEADY` times the squeeze with which the edge does not slide. The ideal squeeze is at most
    the largest squeeze, which leaves a hand the force to turn the box.

    Args:
        thing: the box.
        near: face of one of the hands. The other hand is at the opposite face.
        down: the face on which the box lies before or after the turn.
        force: smaller of the maximal forces of the hands [N].
    """
    weight, friction = GRAVITY * thing["mass"], thing["friction"]
    width, height = 2.0 * half_extent(thing, near), 2.0 * GRIP * half_extent(thing, down)
    hand = DEFAULT_FRICTION * friction
    arm = height + hand * width / 2.0
    touching = _squeeze_of_contact(weight, width, height, friction)
    # With a large squeeze, friction alone lifts the box, and no hand presses harder than the other.
    turning = (force - width * weight / (4.0 * arm)) / (1.0 - hand * width / (2.0 * arm))
    largest = max(turning if hand * force < weight / 2.0 else force, touching)
    needed = squeeze_needed(weight, width, height, friction, thing.ground.friction)
    return min(max(STEADY * needed, SQUEEZE * weight), largest), min(needed, largest), largest


def leaning_friction(height: float, width: float) -> float:
    """Return the smallest friction with which the edge of a box does not slide while a single hand holds the box.

    The box leans over a face past its point of balance, and may sink onto the hand a little. The hand presses on this
    face with the force N. Its moment about the edge balances that of the weight. If the face is turned down by the
    angle phi, the edge does not slide if N cos(phi) <= mu (W - N sin(phi)).

    Args:
        height: length of the face from the edge to its far end [m].
        width: extent of the box along the normal of the face [m].
    """
    lean = PAST_BALANCE + SAG
    press = float(np.hypot(height, width) / 2.0 * np.sin(lean) / (GRIP * height))
    turned = np.arctan2(width, height) + lean
    return float(press * np.cos(turned) / (1.0 - press * np.sin(turned)))
