"""The loads that hands bear by friction: closed forms for the feasibility facts and for the squeeze.

Each of n hands bears the share W = m g/n of the weight. A hand that presses on its face with S bears at most mu S by
friction. It presses RESERVE times as hard as necessary, S = RESERVE W/mu, and its force is the sum of both,
sqrt(S^2 + W^2) <= F_max. So it bears at most W_max = F_max/sqrt(1 + (RESERVE/mu)^2).
"""

import numpy as np

from hybrid_tamp.authoring import GRAVITY, Token

from .places import CREWS

HAND_FRICTION = 0.5
"""Friction coefficient of a hand: the default of the physics for tokens without this property."""
RESERVE = 1.5
"""Squeeze as a multiple of the least one without slip: the box accelerates, and the shares differ a little."""


def friction(thing: Token) -> float:
    """Return the friction coefficient between a hand and a thing: the product of their own ones, as in Bullet."""
    return float(HAND_FRICTION * thing["friction"])


def load(thing: Token, crew: str) -> float:
    """Return the share of a thing's weight that each hand of a crew bears [N]."""
    return float(thing["mass"] * GRAVITY / len(CREWS[crew]))


def squeeze_for(thing: Token, crew: str) -> float:
    """Return the force [N] with which each hand of a crew squeezes a thing to lift it; infinite without friction."""
    coefficient = friction(thing)
    return RESERVE * load(thing, crew) / coefficient if coefficient > 0.0 else np.inf


def bearable(hand: Token, thing: Token) -> float:
    """Return the largest share of the weight of a thing that a hand can bear by friction [N]."""
    coefficient = friction(thing)
    return float(hand["maximal_force"] * coefficient / np.hypot(coefficient, RESERVE))


def largest_squeeze(hand: Token, thing: Token, crew: str) -> float:
    """Return the largest squeeze [N] of a hand that bears its share of the weight; 0 if it cannot bear it."""
    return float(np.sqrt(max(0.0, hand["maximal_force"] ** 2 - load(thing, crew) ** 2)))
