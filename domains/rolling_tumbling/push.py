"""The movement of a roll: a hand pushes an object from behind, at the height of its axis of rotation."""

from dataclasses import replace

import numpy as np

from hybrid_tamp.authoring import Binding, FloatArray, State
from hybrid_tamp.skills import extent, get_tokens, make_sliding

from .geometry import way
from .resistance import rolling_resistance


def _line(binding: Binding, state: State) -> tuple[FloatArray, FloatArray]:
    return way(state, *get_tokens(binding, "object", "region"))


def _touching(binding: Binding, state: State, direction: FloatArray) -> FloatArray:
    """Return the distance ``(...)`` [m] between the centres of a hand and an object that touch each other."""
    hand, thing = get_tokens(binding, "hand", "object")
    return np.asarray(thing["radius_of_rotation"] + extent(state, hand, direction))


ROLL = replace(
    make_sliding(_line),
    touching=_touching,
    resistance=lambda binding: rolling_resistance(*get_tokens(binding, "hand", "object")),
    steered=False,
)
"""The push that rolls an object to a region."""
