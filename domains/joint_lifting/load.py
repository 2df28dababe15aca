"""What hands bear by friction: the closed forms behind the feasibility facts and the squeeze.

Of n hands each bears the share W = m g/n of the weight. A hand that presses on its face with S bears at most mu S by
friction; it presses RESERVE times as hard as that asks for, S = RESERVE W/mu, and its force is the sum of both,
sqrt(S^2 + W^2) <= F_max. So it bears at most W_max = F_max/sqrt(1 + (RESERVE/mu)^2).
"""

import numpy as np

from hybrid_tamp.authoring import GRAVITY, Token

from .places import CREWS

HAND_FRICTION = 0.5
"""Friction coefficient of a hand, as physics takes it for tokens that have no such property."""
RESERVE = 1.5
"""How much harder hands squeeze than they must for the box not to slip: it is accelerated, and shares differ a bit."""


def friction(thing: Token) -> float:
    """Return the coefficient of friction between a hand and a thing, the product of their own ones, as in Bullet."""
    return float(HAND_FRICTION * thing["friction"])


def load(thing: Token, crew: str) -> float:
    """Return the share of a thing's weight that each hand of a crew bears [N]."""
    return float(thing["mass"] * GRAVITY / len(CREWS[crew]))


def squeeze_for(thing: Token, crew: str) -> float:
    """Return how hard each hand of a crew squeezes a thing to lift it [N]; infinite where there is no friction."""
    coefficient = friction(thing)
    return RESERVE * load(thing, crew) / coefficient if coefficient > 0.0 else np.inf


def bearable(hand: Token, thing: Token) -> float:
    """Return the largest share of the weight of a thing that a hand can bear by friction [N]."""
    coefficient = friction(thing)
    return float(hand["maximal_force"] * coefficient / np.hypot(coefficient, RESERVE))


def largest_squeeze(hand: Token, thing: Token, crew: str) -> float:
    """Return how hard a hand can squeeze a thing while it bears its share of the weight [N]; 0 if it cannot bear it."""
    return float(np.sqrt(max(0.0, hand["maximal_force"] ** 2 - load(thing, crew) ** 2)))
