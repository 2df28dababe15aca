"""The height to which hands lift a box."""

from functools import partial

import numpy as np

from hybrid_tamp.authoring import Binding, FloatArray, Hyperparameter, State

from .bearing import Roles
from .predicates import LOWEST_LIFT, room_above

_USUAL, _HIGHEST = 0.15, 0.3
"""Height of a lift by default, and its largest height [m]."""


def usual_height(crew: str, binding: Binding, state: State) -> FloatArray:
    """Return the default height ``(...)`` [m] of a lift, or a lower height if a hand would leave its workspace."""
    roles = Roles.of(crew, binding)
    room = np.min([room_above(state, hand, roles.thing, place) for hand, place in roles.hands], axis=0)
    return np.asarray(np.clip(room, LOWEST_LIFT, _USUAL))


def rising(crew: str) -> Hyperparameter:
    """Return the hyperparameter ``height`` of LIFTING for a crew."""
    description = "height to which the box is lifted"
    return Hyperparameter("height", "m", LOWEST_LIFT, _HIGHEST, partial(usual_height, crew), description)
