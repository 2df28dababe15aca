"""The movement of a roll: a hand pushes an object from behind, at the height of its axis of rotation."""

import numpy as np

from hybrid_tamp.authoring import Binding, FloatArray, State, Token
from hybrid_tamp.skills import Push, get_tokens

from .geometry import touching, way, working_height
from .resistance import rolling_resistance


def _roles(binding: Binding) -> tuple[Token, ...]:
    return get_tokens(binding, "hand", "object", "region")


def _line(binding: Binding, state: State) -> tuple[FloatArray, FloatArray]:
    _, thing, region = _roles(binding)
    return way(state, thing, region)


def _touching(binding: Binding, state: State, direction: FloatArray) -> FloatArray:
    hand, thing, _ = _roles(binding)
    return touching(state, hand, thing, direction)


def _beside(binding: Binding, state: State) -> FloatArray:
    """Return the point ``(..., 3)`` [m] at the height of the object's centre, or higher if the floor is too close."""
    hand, thing, _ = _roles(binding)
    centre = state[thing, "position"]
    return np.concatenate([centre[..., :2], working_height(state, hand, thing)[..., None]], axis=-1)


ROLL = Push(_line, _touching, _beside, lambda binding: rolling_resistance(*get_tokens(binding, "hand", "object")))
"""The push that rolls an object to a region."""
