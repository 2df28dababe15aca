"""Support of bodies: what a body rests on, or how far it is above the floor or the body below."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from hybrid_tamp.geometry.convex import CONTACT, Body, ConvexBody, lowest_height, placed
from hybrid_tamp.geometry.gaps import Swept, distance_between
from hybrid_tamp.geometry.tops import Top, find_tops
from hybrid_tamp.model.grasp import pass_through
from hybrid_tamp.model.ground import ON_FLOOR, Ground
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.constants import DEFAULT_FRICTION

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
    height, below = lowest_height(_body(token, state)), "the floor"
    if height <= MOST_ABOVE:
        return None
    for fall, other in _falls(token, state, tokens):
        if fall < height:
            height, below = fall, other.name
    if height <= MOST_ABOVE:
        return None
    return f"the body must rest on the floor or on another body, but it is {round(height, 4):g} m above {below}"


def with_grounds(tokens: Sequence[Token], state: State) -> tuple[Token, ...]:
    """Return the tokens, each with what it rests on in a state, and with what rests on it.

    Hands, places and bodies that nothing can move rest on nothing.

    Args:
        tokens: all tokens of the task.
        state: initial state, without batch dimensions.
    """
    grounds = {token.name: find_ground(token, state, tokens) for token in tokens}
    burdens: dict[str, list[str]] = {}
    for name, ground in grounds.items():
        burdens.setdefault(ground.body, []).append(name)
    return tuple(
        replace(token, ground=grounds[token.name], burden=burden)
        if (burden := () if token.fixed_body else tuple(burdens.get(token.name, ()))) != token.burden
        or grounds[token.name] != token.ground
        else token
        for token in tokens
    )


def find_ground(token: Token, state: State, tokens: Iterable[Token]) -> Ground:
    """Return what a token rests on. A body that several bodies support rests on the body below its centre.

    Args:
        token: the token.
        state: the state, without batch dimensions.
        tokens: all tokens of the task.
    """
    if not is_body(token, state) or token.fixed_body or token.basic_actions:
        return ON_FLOOR
    lowest = lowest_height(_body(token, state))
    if lowest <= CONTACT:
        return ON_FLOOR
    least = min(lowest, MOST_ABOVE)
    centre = state[token, "position"][:2]
    found: list[tuple[float, Ground]] = []
    for fall, other in _falls(token, state, tokens):
        if fall <= least and not other.basic_actions:
            top = _top_at(other, state, lowest, centre)
            height = lowest if top is None else top.height
            friction = float(other.properties.get("friction", DEFAULT_FRICTION))
            depth = -np.inf if top is None else float(top.depth(centre))
            found.append((depth, Ground(other.name, height, friction, top, other.fixed_body)))
    return max(found, key=lambda each: each[0], default=(0.0, ON_FLOOR))[1]


def _top_at(body: Token, state: State, height: float, centre: FloatArray) -> Top | None:
    """Return the level top of a body near a height [m] that extends the farthest around a point ``(2,)`` [m]."""
    tops = find_tops(body.solid, state[body, "position"], state[body, "orientation"])
    near = [top for top in tops if abs(top.height - height) <= MOST_ABOVE + CONTACT]
    return max(near, key=lambda top: float(top.depth(centre)), default=None)


def _falls(token: Token, state: State, tokens: Iterable[Token]) -> Iterator[tuple[float, Token]]:
    """Yield each body below a token, with the distance [m] by which the token can fall before it touches this body."""
    body = _body(token, state)
    most = lowest_height(body)
    for other in tokens:
        if other.name == token.name or not is_body(other, state) or pass_through(token, other):
            continue
        fall = _fall(body, _body(other, state), most)
        if fall < np.inf:
            yield fall, other


def is_body(token: Token, state: State) -> bool:
    """Return whether a token has a shape and a pose."""
    placed_by = {(token.name, "position"), (token.name, "orientation")}
    return token.shape is not None and placed_by <= state.layout.slices.keys()


def _body(token: Token, state: State) -> Body:
    return placed(token.solid, state[token, "position"], state[token, "orientation"])


def _fall(body: Body, other: Body, most: float) -> float:
    """Return how far [m] a body can fall before it touches another body, or infinity if it can fall by `most`."""
    # A body that touches only the side of another body is not supported, so the falling body is a little thinner.
    thin = [part.shrunk(CONTACT) for part in body]
    free, touching = 0.0, most + CONTACT
    if not any(_over(part, obstacle) for part in body for obstacle in other) or not _meets(thin, other, touching):
        return float("inf")
    while touching - free > _PRECISION:
        middle = (free + touching) / 2.0
        free, touching = (free, middle) if _meets(thin, other, middle) else (middle, touching)
    return max(free - CONTACT, 0.0)


def _over(part: ConvexBody, obstacle: ConvexBody) -> bool:
    """Return whether the balls that contain two solids overlap, seen from above."""
    return float(np.hypot(*(part.position - obstacle.position)[:2])) < part.reach + obstacle.reach


def _meets(body: Body, other: Body, fall: float) -> bool:
    """Return whether a body that falls by a distance [m] meets another body on its way."""
    return any(distance_between(Swept(part, fall), obstacle) < _PRECISION / 10 for part in body for obstacle in other)
