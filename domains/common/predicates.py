"""Predicates that several domains use."""

import numpy as np

from hybrid_tamp.authoring import TOKEN, FloatArray, Kind, ObjectClass, Parameter, Predicate, State, Token

from .classes import Region

REST_SPEED = 0.02
"""A token that moves no faster than this is at rest [m/s]."""


def _slowness(state: State, token: Token) -> FloatArray:
    return np.asarray(REST_SPEED - np.linalg.norm(state[token, "velocity"], axis=-1))


AT_REST = Predicate(
    "at_rest",
    (Parameter("token", TOKEN),),
    _slowness,
    unit="m/s",
    scale=REST_SPEED,
    reads={"token": ("velocity",)},
    description="{token} is at rest",
    denial="{token} is not at rest",
)


def _depth(state: State, thing: Token, region: Token) -> FloatArray:
    offset = (state[thing, "position"] - state[region, "position"])[..., :2]
    return np.asarray(region["radius"] - np.linalg.norm(offset, axis=-1))


def inside(movable: type[ObjectClass]) -> Predicate:
    """Return the predicate that a thing of the class is inside a region; it is inside one at a time."""
    return Predicate(
        "inside",
        (Parameter("object", movable), Parameter("region", Region)),
        _depth,
        unit="m",
        scale=0.01,
        reads={"object": ("position",), "region": ("position",)},
        kind=Kind.FUNCTIONAL,
        value_of="region",
        description="{object} is inside {region}",
        denial="{object} is not inside {region}",
    )
