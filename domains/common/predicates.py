"""Predicates that several domains use."""

import numpy as np

from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.predicate import Parameter, Predicate
from hybrid_tamp.model.state import FloatArray, State
from hybrid_tamp.model.token import Token

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
)
