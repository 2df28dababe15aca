"""Closed forms of the loads that hands bear by friction. Feasibility facts and the squeeze use them.

Each of n hands bears the share W = m g/n of the weight. A hand that presses on its face with a force S can bear mu S by
friction. It squeezes RESERVE times as hard as necessary: S = RESERVE W/mu. Its total force is the vector sum of S and
W, so sqrt(S^2 + W^2) <= F_max. The hand can thus bear at most W_max = F_max/sqrt(1 + (RESERVE/mu)^2).
"""

import numpy as np

from hybrid_tamp.authoring import GRAVITY, Token

from .places import CREWS

HAND_FRICTION = 0.5
"""Friction coefficient of a hand: the default of the physics engine for tokens without this property."""
RESERVE = 1.5
"""Factor on the smallest squeeze without slip, because the box accelerates and the hands' shares differ a little."""


def friction(thing: Token) -> float:
    """Return the friction coefficient between a hand and an object: the product of their coefficients, as in Bullet."""
    return float(HAND_FRICTION * thing["friction"])


def load(thing: Token, crew: str) -> float:
    """Return the share [N] of an object's weight that each hand of a crew bears."""
    return float(thing["mass"] * GRAVITY / len(CREWS[crew]))


def squeeze_for(thing: Token, crew: str) -> float:
    """Return the squeeze [N] of each hand of a crew that lifts an object. It is infinite without friction."""
    coefficient = friction(thing)
    return RESERVE * load(thing, crew) / coefficient if coefficient > 0.0 else np.inf


def bearable(hand: Token, thing: Token) -> float:
    """Return the largest share [N] of an object's weight that a hand can bear by friction."""
    coefficient = friction(thing)
    return float(hand["maximal_force"] * coefficient / np.hypot(coefficient, RESERVE))


def largest_squeeze(hand: Token, thing: Token, crew: str) -> float:
    """Return the largest squeeze [N] of a hand that bears its share of the weight, or 0 if the hand is too weak."""
    return float(np.sqrt(max(0.0, hand["maximal_force"] ** 2 - load(thing, crew) ** 2)))
