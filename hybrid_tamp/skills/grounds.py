"""Facts about what an object rests on, and what rests on the object."""

import numpy as np

from hybrid_tamp.model.affordance import TOKEN, ObjectClass
from hybrid_tamp.model.predicate import Parameter, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.skills.classes import Region
from hybrid_tamp.skills.predicates import competence

_LEVEL = 0.015
"""Largest difference between the heights of a region and of the ground of an object [m]."""


def _freedom(thing: Token) -> float:
    return -float(len(thing.burden)) if thing.burden else float(thing.ground.firm) - 0.5


def _hindrance(state: State, thing: Token) -> str:
    """Return what keeps an object from being moved."""
    if thing.burden:
        *others, last = thing.burden
        return f"{', '.join(others)} and {last} lie on it" if others else f"{last} lies on it"
    if thing.ground.fixed:
        return f"{thing.ground.text} is not level"
    return f"it rests on {thing.ground.body}, which is not fixed"


FREE_TO_MOVE = competence(
    "free_to_move",
    (Parameter("object", TOKEN),),
    _freedom,
    unit="1",
    scale=1.0,
    detail=_hindrance,
    description="{object} rests on the floor or on the level top of a fixed body, and nothing rests on {object}",
    denial="{object} is not free to move",
)
"""Feasibility fact of blocks that move an object along its ground. The fact describes the initial state."""


def level_with(movable: type[ObjectClass]) -> Predicate:
    """Return the feasibility fact `level_with` (object, region): a region lies on the surface on which an object rests.

    The top of a table is convex. So an object that rests on a table stays on it on its way to such a region.
    """

    def above(state: State, thing: Token, region: Token) -> FloatArray:
        """Return the height ``(...)`` [m] of the region above the ground of the object."""
        return state[region, "position"][..., 2] - thing.ground.height

    def margin(state: State, thing: Token, region: Token) -> FloatArray:
        """Return the smaller of the closeness in height and of the depth within the edges of the surface [m]."""
        depth = thing.ground.depth(state[region, "position"][..., :2])
        return np.asarray(np.minimum(_LEVEL - np.abs(above(state, thing, region)), depth))

    def describe(state: State, thing: Token, region: Token) -> str:
        height = float(above(state, thing, region))
        if abs(height) > _LEVEL:
            return f"{region.name} lies {abs(height):.3g} m {'above' if height > 0 else 'below'} {thing.ground.text}"
        beyond = -float(margin(state, thing, region))
        return f"the middle of {region.name} is {beyond:.3g} m beyond {thing.ground.edge}"

    return competence(
        "level_with",
        (Parameter("object", movable), Parameter("region", Region)),
        margin,
        reads={"region": ("position",)},
        detail=describe,
        description="{region} lies on the surface on which {object} rests",
        denial="{region} does not lie on the surface on which {object} rests",
    )
