"""Clearance as conditions of rollouts: the distances of a movement from bodies at rest, for whole populations.

Rollouts evaluate the conditions at sampled poses, with lower bounds of the distances. So an optimiser moves a grazing
movement away from a body. The search by bisection (`clearance`) decides afterwards.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np

from hybrid_tamp.collision.bounds import Poses, bound_distances
from hybrid_tamp.midlevel.instance_model import Guard
from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.predicate import Literal, Parameter, Predicate
from hybrid_tamp.model.refined import CLEAR
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.motion.arrays import FloatArray
from hybrid_tamp.planning.clearance import Sweep

_SCALE = 0.01
"""Scale of a clearance [m]."""
_PARAMETERS = Parameter("moving", TOKEN), Parameter("other", TOKEN)


def make_guard(task: Task, movement: Sweep, distances: Sequence[float]) -> Guard:
    """Return the conditions that a movement keeps its distance from all bodies at rest.

    Args:
        task: task of the plan.
        movement: a movement of the instance. Other candidates start near its start.
        distances: distances to keep from the neighbours of all tracks in turn [m].
    """
    slots = {token: slot for slot, token in movement.instance.slots.items()}
    literals, others, kept = [], {}, iter(distances)
    for track, neighbours in zip(movement.tracks, movement.neighbours, strict=True):
        for each in neighbours:
            key = f"{each.body.name} at rest"
            others[key] = task.token_by_name[each.body.name]
            margin = partial(_margin, next(kept))
            predicate = Predicate(CLEAR, _PARAMETERS, margin, unit="m", scale=_SCALE)
            literals.append(Literal(predicate, (slots[track.body.name], key)))
    return Guard(tuple(literals), others)


def _margin(kept: float, state: State, moving: Token, other: Token) -> FloatArray:
    """Return a lower bound of the distance between two tokens minus the distance to keep [m], shape ``(...)``."""
    bounds = bound_distances(moving.solid, _poses(state, moving), other.solid, _poses(state, other))
    return np.asarray(bounds.reshape(state.values.shape[:-1]) - kept)


def _poses(state: State, token: Token) -> Poses:
    return Poses(state[token, "position"].reshape(-1, 3), state[token, "orientation"].reshape(-1, 4))
