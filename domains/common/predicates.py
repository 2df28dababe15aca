"""Predicates that several domains use, and makers of margins and predicates."""

from collections.abc import Callable
from functools import partial

import numpy as np

from hybrid_tamp.authoring import TOKEN, FloatArray, Kind, ObjectClass, Parameter, Predicate, State, Token, Value

from .classes import Region

REST_SPEED = 0.02
"""A token that moves no faster than this is at rest [m/s]."""

length_predicate = partial(Predicate, unit="m", scale=0.01)
"""Make a predicate whose margin is a length."""


def everywhere(margin: Callable[..., float]) -> Callable[..., FloatArray]:
    """Make a margin of batches from one of fixed properties, which takes no state."""
    return lambda state, *values: np.full(state.values.shape[:-1], margin(*values))


def one_by_one(margin: Callable[..., FloatArray]) -> Callable[..., FloatArray]:
    """Make a margin of batches from one of single states. It is slow; use it for static predicates."""

    def batched(state: State, *values: Value) -> FloatArray:
        rows = state.values.reshape(-1, state.values.shape[-1])
        found = [float(margin(State(state.layout, row), *values)) for row in rows]
        return np.array(found).reshape(state.values.shape[:-1])

    return batched


def near(tolerance: float, place: Callable[..., FloatArray]) -> Callable[..., FloatArray]:
    """Make the margin [m] of a hand near a place.

    Args:
        tolerance: largest distance of the hand [m].
        place: ``place(state, hand, *values)`` of the hand's centre ``(..., 3)`` [m].
    """

    def margin(state: State, hand: Token, *values: Value) -> FloatArray:
        offset = state[hand, "position"] - place(state, hand, *values)
        return np.asarray(tolerance - np.linalg.norm(offset, axis=-1))

    return margin


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


def depth_in_region(state: State, thing: Token, region: Token) -> FloatArray:
    """Return how far the centre of a thing lies inside a region, ``(...)`` [m]; negative outside."""
    offset = (state[thing, "position"] - state[region, "position"])[..., :2]
    return np.asarray(region["radius"] - np.linalg.norm(offset, axis=-1))


def inside(movable: type[ObjectClass]) -> Predicate:
    """Return the predicate that a member of the class is inside a region, of which there is one at a time."""
    return length_predicate(
        "inside",
        (Parameter("object", movable), Parameter("region", Region)),
        depth_in_region,
        reads={"object": ("position",), "region": ("position",)},
        kind=Kind.FUNCTIONAL,
        value_of="region",
        description="{object} is inside {region}",
        denial="{object} is not inside {region}",
    )
