"""Pushes of objects that slide on the floor or on surfaces."""

from collections.abc import Callable

import numpy as np

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.extents import extent
from hybrid_tamp.model.predicate import Binding, Parameter, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.skills.classes import Surface
from hybrid_tamp.skills.extents import depth_over, ground_below, height_above, height_below
from hybrid_tamp.skills.predicates import competence
from hybrid_tamp.skills.pushing import Push, Resistance
from hybrid_tamp.skills.roles import POSE, get_token, get_tokens

_CLEARANCE = 0.01
"""Gap between a hand and the surface on which it pushes [m]."""
_LYING = 0.01
"""Largest height above a surface at which a body lies on it [m]."""


def make_sliding(line: Callable[[Binding, State], tuple[FloatArray, FloatArray]], *surfaces: str) -> Push:
    """Return the push of an object that slides with Coulomb friction. The hand touches its far side.

    Args:
        line: returns the direction ``(..., 3)`` and the distance ``(...)`` [m] of the push (see `Push`).
        *surfaces: roles of the surfaces on which the object can lie, or none for the floor. The first of them is the
            surface on which the hand pushes. Beyond its edge, the object falls.
    """

    def touching(binding: Binding, state: State, direction: FloatArray) -> FloatArray:
        hand, thing = get_tokens(binding, "hand", "object")
        return np.asarray(extent(state, thing, -direction) + extent(state, hand, direction))

    def beside(binding: Binding, state: State) -> FloatArray:
        """Return the object's centre, or a higher point if the surface is too close to the hand."""
        hand, thing = get_tokens(binding, "hand", "object")
        centre, low = state[thing, "position"], height_below(state, thing)
        higher = np.maximum(height_below(state, hand) + _CLEARANCE - low, 0.0)
        return np.concatenate([centre[..., :2], (centre[..., 2] + higher)[..., None]], axis=-1)

    def resistance(binding: Binding) -> Resistance:
        thing = get_token(binding, "object")
        friction = thing["friction"] * (get_token(binding, surfaces[0])["friction"] if surfaces else 1.0)
        return Resistance(friction * GRAVITY * thing["mass"], friction * GRAVITY, thing["mass"])

    def ground(binding: Binding, state: State) -> FloatArray:
        return ground_below(state, state[get_token(binding, "object"), "position"], get_tokens(binding, *surfaces))

    return Push(line, touching, beside, resistance, ground if surfaces else None, steered=True)


def lies_on(movable: type[ObjectClass]) -> Predicate:
    """Return the feasibility fact `lies_on` (object, surface): a body lies on the top of a surface."""

    def margin(state: State, thing: Token, surface: Token) -> FloatArray:
        """Return the smaller of the depth in the outline of the surface, and of the closeness to its top [m]."""
        return np.asarray(
            np.minimum(depth_over(state, thing, surface), _LYING - np.abs(height_above(state, thing, surface)))
        )

    return competence(
        "lies_on",
        (Parameter("object", movable), Parameter("surface", Surface)),
        margin,
        reads={"object": POSE, "surface": POSE},
        description="{object} lies on {surface}",
        denial="{object} does not lie on {surface}",
    )
