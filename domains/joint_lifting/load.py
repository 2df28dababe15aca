"""Loads that hands bear by friction, in closed form. Feasibility facts and the squeeze are computed from these loads.

Each of n hands bears the share W = m g/n of the weight. A hand that presses on its face with a force S can bear mu S by
friction. A hand that squeezes k times as hard as necessary has the squeeze S = k W/mu. The hand's total force is the
vector sum of S and W, so sqrt(S^2 + W^2) <= F_max. The hand can thus bear at most W_max = F_max/sqrt(1 + (k/mu)^2). The
safety factor k is RESERVE by default. The physical bound has k = 1.
"""

import numpy as np

from hybrid_tamp.authoring import DEFAULT_FRICTION, GRAVITY, Token

from .places import CREWS, height_of_hand

RESERVE = 1.5
"""Ratio of the squeeze to the smallest squeeze without slip. The reserve covers acceleration and unequal shares."""
SMALLEST_SQUEEZE = 1.0
"""Smallest squeeze of strong hands [N]. With a smaller squeeze, the errors of the hands would let a light box slip."""


def friction(thing: Token) -> float:
    """Return the friction coefficient between a hand and an object: the product of their coefficients, as in Bullet."""
    return float(DEFAULT_FRICTION * thing["friction"])


def load(thing: Token, crew: str) -> float:
    """Return the part of an object's weight [N] that each hand of a crew bears."""
    return float(thing["mass"] * GRAVITY / len(CREWS[crew]))


def squeeze_for(thing: Token, crew: str) -> float:
    """Return the squeeze [N] of strong hands in a crew that lifts an object, or infinity if the friction is zero."""
    coefficient = friction(thing)
    return max(RESERVE * load(thing, crew) / coefficient, SMALLEST_SQUEEZE) if coefficient > 0.0 else np.inf


def bearable(hand: Token, thing: Token, factor: float) -> float:
    """Return the largest part of an object's weight [N] that a hand can bear by friction with a safety factor."""
    coefficient = friction(thing)
    return float(hand["maximal_force"] * coefficient / np.hypot(coefficient, factor))


def wrist_moment(hand: Token, thing: Token, crew: str) -> float:
    """Return the moment [N m] that the wrist of a hand in a crew must bear to stay upright.

    The weight acts on the surface of the hand, at a distance from its axis. The squeeze balances this moment if its
    centre is above the centre of the hand, but the centre of the squeeze cannot be above the top of the box.
    """
    below_top = float(thing["half_extents"][2]) - height_of_hand(hand, thing)
    return max(0.0, load(thing, crew) * float(hand["radius"]) - squeeze_for(thing, crew) * below_top)


def largest_squeeze(hand: Token, thing: Token, crew: str) -> float:
    """Return the largest squeeze [N] of a hand that bears its share of the weight, or 0 if the hand is too weak."""
    return float(np.sqrt(max(0.0, hand["maximal_force"] ** 2 - load(thing, crew) ** 2)))
