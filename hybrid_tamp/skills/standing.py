"""Facts that an object with a handle stands upright, on the floor or on a surface."""

from typing import Any

import numpy as np

from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.predicate import Parameter, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.skills.classes import Surface
from hybrid_tamp.skills.extents import depth_over, top_of
from hybrid_tamp.skills.grippers import Graspable
from hybrid_tamp.skills.handles import lean, side, standing_height
from hybrid_tamp.skills.predicates import length_predicate
from hybrid_tamp.skills.roles import POSE

_FOOT_TOLERANCE = 0.005
"""Largest distance of the foot of an object that stands from what it stands on [m]."""
_TILT_TOLERANCE = np.radians(5.0)
"""Largest tilt of an object that stands [rad]."""


def stands(thing: type[Graspable], role: str = "object", **told: Any) -> Predicate:
    """Return the predicate `stands` (object): an object stands upright on the floor.

    Args:
        thing: class of the object.
        role: role of the object in the messages of the predicate.
        **told: further arguments of `Predicate`, e.g. another `description` and `denial`.
    """
    said = {"description": f"{{{role}}} stands on the floor", "denial": f"{{{role}}} does not stand on the floor"}
    return length_predicate("stands", (Parameter(role, thing),), standing, reads={role: POSE}, **(said | told))


def stands_on(thing: type[Graspable], role: str = "object") -> Predicate:
    """Return the predicate `stands_on` (object, surface): an object stands upright on the top of a surface.

    An object stands on at most one surface at a time.
    """

    def margin(state: State, thing: Token, surface: Token) -> FloatArray:
        """Return the smallest margin [m] of the attitude, of the height, and of the depth within the outline."""
        upright = standing(state, thing, top_of(state, surface))
        return np.asarray(np.minimum(upright, depth_over(state, thing, surface)))

    return length_predicate(
        "stands_on",
        (Parameter(role, thing), Parameter("surface", Surface)),
        margin,
        reads={role: POSE, "surface": POSE},
        kind=Kind.FUNCTIONAL,
        value_of="surface",
        description=f"{{{role}}} stands on {{surface}}",
        denial=f"{{{role}}} does not stand on {{surface}}",
    )


def standing(state: State, thing: Token, ground: FloatArray | float = 0.0) -> FloatArray:
    """Return a margin ``(...)`` [m] that is positive if an object stands upright on a ground of a height [m]."""
    upright = _TILT_TOLERANCE - np.abs(lean(state, thing))
    level = _TILT_TOLERANCE - np.abs(side(state, thing)[..., 2])
    height = _FOOT_TOLERANCE - np.abs(state[thing, "position"][..., 2] - ground - standing_height(thing))
    return np.asarray(np.minimum(np.minimum(upright, level) * _FOOT_TOLERANCE / _TILT_TOLERANCE, height))
