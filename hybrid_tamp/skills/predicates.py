"""Predicates that several domains share, and functions that make margins and predicates."""

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import numpy as np

from hybrid_tamp.geometry.shapes import Box, Cylinder, Sphere
from hybrid_tamp.geometry.surfaces import points_of
from hybrid_tamp.model.affordance import TOKEN, ObjectClass
from hybrid_tamp.model.disc import Disc
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.predicate import Literal, Parameter, Predicate, Value
from hybrid_tamp.model.state import State
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.skills.alignment import Alignment
from hybrid_tamp.skills.classes import Region, StaticEndEffector
from hybrid_tamp.skills.roles import POSE
from hybrid_tamp.skills.vectors import depth_in_workspace, norm

REST_SPEED = 0.02
"""Largest speed at which a token counts as at rest [m/s]."""

_RISE = 0.02
"""Largest change of the height of a box, cylinder or sphere that is pushed or rolled, relative to the height."""

length_predicate = partial(Predicate, unit="m", scale=0.01)
"""Makes a predicate with a margin in metres."""


def everywhere(margin: Callable[..., float]) -> Callable[..., FloatArray]:
    """Turn a margin that depends only on fixed properties into a margin ``(...)`` for batches of states."""
    return lambda state, *values, **factor: np.full(state.values.shape[:-1], margin(*values, **factor))


def physical_bound(name: str, parameters: tuple[Parameter, ...], margin: Callable[..., Any], **told: Any) -> Predicate:
    """Return a feasibility fact that states what physics allows at best.

    Args:
        name: name of the predicate.
        parameters: parameters of the predicate.
        margin: ``margin(state, *values)`` returns the margin ``(...)``. Without `reads`, the margin depends on fixed
            properties only, and ``margin(*values)`` returns a number.
        **told: further arguments of `Predicate`. The default unit is the metre, with a scale of 0.01 m.
    """
    batched = margin if "reads" in told else everywhere(margin)
    return Predicate(name, parameters, batched, kind=Kind.STATIC, **{"unit": "m", "scale": 0.01, **told})


def competence(name: str, parameters: tuple[Parameter, ...], margin: Callable[..., Any], **told: Any) -> Predicate:
    """Return a feasibility fact that states what the blocks can do. The arguments are those of `physical_bound`."""
    return physical_bound(name, parameters, margin, competence=True, **told)


def one_by_one(margin: Callable[..., FloatArray]) -> Callable[..., FloatArray]:
    """Turn a static predicate's margin for one state into a margin ``(...)`` that loops over a batch of states."""

    def batched(state: State, *values: Value, **factor: float) -> FloatArray:
        rows = state.values.reshape(-1, state.values.shape[-1])
        found = [float(margin(State(state.layout, row), *values, **factor)) for row in rows]
        return np.array(found).reshape(state.values.shape[:-1])

    return batched


def conditions(predicates: Iterable[Predicate], **roles: str) -> tuple[Literal, ...]:
    """Return the condition of each predicate for the roles of a block.

    Args:
        predicates: the predicates.
        **roles: maps names of parameters to roles or symbols, e.g. ``hand="first"``. Every other parameter stands for
            the role of the same name.
    """
    return tuple(each(*(roles.get(p.name, p.name) for p in each.parameters)) for each in predicates)


def near(
    tolerance: float, place: Callable[..., FloatArray], alignment: Alignment | None = None
) -> Callable[..., FloatArray]:
    """Return a margin [m] that is positive if a hand is close enough to a place.

    Args:
        tolerance: largest distance of the hand's centre from the place [m].
        place: ``place(state, hand, *values)`` returns the place ``(..., 3)`` [m] for the hand's centre.
        alignment: how a hand that can turn must lie there. None if the orientation of the hand does not matter.
    """

    def margin(state: State, hand: Token, *values: Value) -> FloatArray:
        offset = state[hand, "position"] - place(state, hand, *values)
        depth = np.asarray(tolerance - norm(offset))
        return depth if alignment is None else alignment.limit(depth, tolerance, state, hand, *values)

    return margin


def at_place(
    name: str,
    parameters: tuple[Parameter, ...],
    tolerance: float,
    place: Callable[..., FloatArray],
    alignment: Alignment | None = None,
    **told: Any,
) -> Predicate:
    """Return the maintained predicate that a hand is at its place beside an object.

    Args:
        name: name of the predicate.
        parameters: parameters of the predicate. The first two are the hand and the object.
        tolerance: largest distance of the hand's centre from the place [m].
        place: ``place(state, hand, *values)`` returns the place ``(..., 3)`` [m] for the hand's centre.
        alignment: how a hand that can turn must lie there. None if the orientation of the hand does not matter.
        **told: further arguments of `Predicate`. By default, the margin reads the poses of hand and object.
    """
    reads = {parameter.name: POSE for parameter in parameters[:2]}
    return length_predicate(
        name, parameters, near(tolerance, place, alignment), **{"reads": reads, "kind": Kind.MAINTAINED, **told}
    )


def outside(movable: type[ObjectClass], gap: Callable[[State, Token, Token], FloatArray]) -> Predicate:
    """Return the predicate `outside` (hand, object): a hand does not pass through an object.

    Args:
        movable: class of the object.
        gap: ``gap(state, hand, thing)`` returns the distance ``(...)`` [m] between the hand and the object.
    """
    return length_predicate(
        "outside",
        (Parameter("hand", StaticEndEffector), Parameter("object", movable)),
        gap,
        reads={"hand": POSE, "object": POSE},
        description="{hand} is outside {object}",
        denial="{hand} passes through {object}",
    )


def _slowness(state: State, token: Token) -> FloatArray:
    return np.asarray(REST_SPEED - norm(state[token, "velocity"]))


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
    """Return the depth ``(...)`` [m] of an object's centre inside a region. The depth is negative outside."""
    offset = (state[thing, "position"] - state[region, "position"])[..., :2]
    return np.asarray(region["radius"] - norm(offset))


def _distance(state: State, thing: Token, region: Token) -> FloatArray:
    """Return the horizontal distance ``(...)`` [m] between the centres of an object and a region."""
    return np.asarray(region["radius"] - depth_in_region(state, thing, region))


def _disc(state: State, thing: Token, region: Token) -> Disc:
    """Return the disc of an object's centre above a region. Blocks that bring objects to regions keep the height."""
    x, y, _ = (float(part) for part in state[region, "position"])
    height = float(state[thing, "position"][2])
    if isinstance(thing.shape, Box | Cylinder | Sphere):
        lowest, highest = (1.0 - _RISE) * height, (1.0 + _RISE) * height
    else:
        # Other bodies may lie on another side, and rise while they roll over an edge.
        lowest, highest = 0.0, float(np.linalg.norm(points_of(thing.solid), axis=-1).max())
    return Disc((x, y), float(region["radius"]), lowest, highest)


def inside(movable: type[ObjectClass], confines: Callable[..., Disc] | None = _disc) -> Predicate:
    """Return the predicate `inside` for objects of a class. An object is inside at most one region at a time.

    Args:
        movable: class of the objects.
        confines: see `Predicate.confines`. By default, an object in a region has about its present height.
    """
    return length_predicate(
        "inside",
        (Parameter("object", movable), Parameter("region", Region)),
        depth_in_region,
        reads={"object": ("position",), "region": ("position",)},
        kind=Kind.FUNCTIONAL,
        value_of="region",
        confines=confines,
        distance=_distance,
        description="{object} is inside {region}",
        denial="{object} is not inside {region}",
    )


IN_WORKSPACE = length_predicate(
    "in_workspace",
    (Parameter("hand", StaticEndEffector),),
    lambda state, hand: depth_in_workspace(hand, state[hand, "position"]),
    reads={"hand": ("position",)},
    description="{hand} is within its workspace",
    denial="{hand} is not within its workspace",
)
