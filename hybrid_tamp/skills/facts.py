"""Makers of feasibility facts that several domains share: workspaces, shared loads, and objects that are too light."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.margins import SafetyFactor
from hybrid_tamp.model.predicate import Parameter, Predicate, Value
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.motion.constants import GRAVITY
from hybrid_tamp.skills.predicates import competence, one_by_one
from hybrid_tamp.skills.vectors import depth_in_workspace, largest_depth


def within_reach(
    name: str,
    parameters: tuple[Parameter, ...],
    places: Callable[..., Sequence[FloatArray]],
    carried: bool = False,
    **told: Any,
) -> Predicate:
    """Return the feasibility fact that all places of a hand are in its workspace. Without places, it does not hold.

    Args:
        name: name of the predicate.
        parameters: parameters of the predicate. The first parameter is the hand.
        places: ``places(state, hand, *values)`` returns the positions ``(..., 3)`` [m] of the hand's centre.
        carried: whether all places move with the object, by the same displacement. The fact then has a `bound`, and
            `places` gets single states only.
        **told: further arguments of `Predicate`.
    """

    def depth(state: State, hand: Token, *values: Value) -> FloatArray:
        depths = [depth_in_workspace(hand, place) for place in places(state, hand, *values)]
        return np.asarray(np.min(depths, axis=0) if depths else np.full(state.values.shape[:-1], -1.0))

    def bound(state: State, radius: float, hand: Token, *values: Value) -> FloatArray:
        depths = [float(largest_depth(hand, place, radius)) for place in places(state, hand, *values)]
        return np.asarray(min(depths, default=-1.0))

    if carried:
        return competence(name, parameters, one_by_one(depth), bound=bound, **told)
    return competence(name, parameters, depth, **told)


def bears_share(
    name: str,
    parameters: tuple[Parameter, ...],
    share: Callable[..., tuple[float, float]],
    factor: float,
    covers: str,
    **told: Any,
) -> Predicate:
    """Return the feasibility fact that a hand bears its share of a load, with a safety factor.

    Args:
        name: name of the predicate.
        parameters: parameters of the predicate.
        share: ``share(state, *values, factor)`` returns a pair of (load, largest load) of the hand [N], for one state.
        factor: default value of the safety factor.
        covers: what the factor multiplies, and what the factor covers.
        **told: further arguments of `Predicate`.
    """

    def margin(state: State, *values: Value, factor: float) -> FloatArray:
        load, most = share(state, *values, factor)
        return np.asarray(most - load)

    safety = SafetyFactor(factor, covers)
    return Predicate(
        name,
        parameters,
        one_by_one(margin),
        **{"unit": "N", "scale": 10.0, "kind": Kind.STATIC, "share": share, "safety": safety, **told},
    )


def heavy_enough(movable: type[ObjectClass], least: float, verb: str, instead: str) -> Predicate:
    """Return the feasibility fact `heavy_enough` (object): the errors of the hands do not decide how an object moves.

    Args:
        movable: class of the object.
        least: smallest weight of the object [N].
        verb: what hands do with the object, e.g. ``"lift"``.
        instead: what hands would do with a lighter object, e.g. ``"tilt it instead of lifting it"``.
    """
    return competence(
        "heavy_enough",
        (Parameter("object", movable),),
        lambda thing: float(GRAVITY * thing["mass"]) - least,
        unit="N",
        scale=least,
        description=f"{{object}} is heavy enough for hands that {verb} it",
        denial=f"{{object}} is so light that hands would {instead}",
    )
