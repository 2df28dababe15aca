"""Support of bodies: what a body rests on, or how far it is above the floor or the body below."""

from collections.abc import Iterable

from hybrid_tamp.geometry.convex import CONTACT, Body, lowest_height, placed
from hybrid_tamp.geometry.gaps import Swept, distance_between
from hybrid_tamp.model.grasp import pass_through
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token

MOST_ABOVE = 0.01
"""Largest height above the floor or another body at which a body counts as resting [m]."""
_PRECISION = 1e-5
"""Largest error of a height [m]."""


def find_floating(token: Token, state: State, tokens: Iterable[Token]) -> str | None:
    """Return an error message if a body starts in the air, or None if the floor or another body supports it.

    Classes whose members obey gravity call this function in `consistent_start`.

    Args:
        token: the body.
        state: initial state, without batch dimensions.
        tokens: all tokens of the task.
    """
    if token.shape is None:
        return None
    body = _body(token, state)
    height, below = lowest_height(body), "the floor"
    if height <= MOST_ABOVE:
        return None
    for other in tokens:
        if other.name == token.name or other.shape is None or pass_through(token, other):
            continue
        fall = _fall(body, _body(other, state), height)
        if fall < height:
            height, below = fall, other.name
    if height <= MOST_ABOVE:
        return None
    return f"the body must rest on the floor or on another body, but it is {round(height, 4):g} m above {below}"


def _body(token: Token, state: State) -> Body:
    return placed(token.solid, state[token, "position"], state[token, "orientation"])


def _fall(body: Body, other: Body, most: float) -> float:
    """Return how far [m] a body can fall before it touches another body, or infinity if it can fall by `most`."""
    # A body that touches only the side of another body is not supported, so the falling body is a little thinner.
    thin = [part.shrunk(CONTACT) for part in body]
    free, touching = 0.0, most + CONTACT
    if not _meets(thin, other, touching):
        return float("inf")
    while touching - free > _PRECISION:
        middle = (free + touching) / 2.0
        free, touching = (free, middle) if _meets(thin, other, middle) else (middle, touching)
    return max(free - CONTACT, 0.0)


def _meets(body: Body, other: Body, fall: float) -> bool:
    """Return whether a body that falls by a distance [m] meets another body on its way."""
    return any(distance_between(Swept(part, fall), obstacle) < _PRECISION / 10 for part in body for obstacle in other)
