"""Influence of each hyperparameter on the performance measures and on its own action."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from hybrid_tamp.midlevel.objective import Objective
from hybrid_tamp.midlevel.predictions import Rollout
from hybrid_tamp.midlevel.scores import SAME
from hybrid_tamp.midlevel.screening import Screening
from hybrid_tamp.model.refined import MeasureKey
from hybrid_tamp.motion.arrays import FloatArray


@dataclass(frozen=True)
class Influence:
    """The effects of the variables of a search.

    Attributes:
        moves: maps the name of each variable to the performance measures that the variable changes.
        own: names of the variables that change a condition or a measure of the block instance to which they belong.
    """

    moves: Mapping[str, tuple[MeasureKey, ...]] = field(default_factory=dict)
    own: frozenset[str] = frozenset()


def find_influence(objective: Objective, screening: Screening, sampled: Rollout) -> Influence:
    """Return the effects of each variable, found in the population that was rolled out for screening."""
    moves: dict[str, tuple[MeasureKey, ...]] = {}
    for measure, figures in sampled.figures.items():
        for name in screening.find_moving(figures):
            moves[name] = (*moves.get(name, ()), measure)
    names = dict(zip(objective.keys, objective.space.names, strict=True))
    own: set[str] = set()
    for instance in {instance for instance, _ in names}:
        mine = [c.violation for c in sampled.conditions if c.where == instance]
        mine += [figures for (owner, _), figures in sampled.figures.items() if owner == instance]
        moving = {name for figures in mine for name in screening.find_moving(figures)}
        own |= {name for (owner, _), name in names.items() if owner == instance and name in moving}
    return Influence(moves, frozenset(own))


def find_moved_measures(rollouts: list[Rollout]) -> tuple[MeasureKey, ...]:
    """Return the performance measures that differ between candidates of the given populations."""
    figures = {key: np.concatenate([rollout.figures[key] for rollout in rollouts]) for key in rollouts[0].figures}
    return tuple(key for key, each in figures.items() if _spread(each) > SAME)


def is_idle(rollouts: list[Rollout]) -> bool:
    """Return whether all candidates have the same violation and the same performance measures."""
    violation = np.concatenate([rollout.violation for rollout in rollouts])
    return not find_moved_measures(rollouts) and _spread(violation) <= SAME


def _spread(figures: FloatArray) -> float:
    finite = figures[np.isfinite(figures)]
    return float(np.ptp(finite)) if len(finite) else 0.0
