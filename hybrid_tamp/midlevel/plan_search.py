"""The search for the hyperparameters of one plan: which of them matter, and where they are best.

In a space of several variables a screening finds those that have an effect at all; the others keep their defaults,
which shrinks the space that is searched. The search begins at the defaults, or where each action is best on its own.
"""

import time
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

import numpy as np

from hybrid_tamp.errors import DomainError, Issue
from hybrid_tamp.midlevel.influence import Influence, find_influence, find_moved_measures, is_idle
from hybrid_tamp.midlevel.objective import Evaluator, Objective
from hybrid_tamp.midlevel.optimiser import Budget, NothingFinite, Optimum
from hybrid_tamp.midlevel.registry import find_optimiser
from hybrid_tamp.midlevel.screening import Effect, Screening, screen_hyperparameters
from hybrid_tamp.midlevel.separate import optimise_apart
from hybrid_tamp.model.refined import Milestone
from hybrid_tamp.model.task import MidLevel
from hybrid_tamp.motion.arrays import FloatArray

Progress = Callable[[float, Milestone], None]
"""Called with the share of the budget that is spent, 0 to 1, and the best so far."""

_BATCHES = {"cma": 48}
"""Candidates of a generation, by optimiser: rolled out together they cost little more than one."""
_SCREENING = 0.4
"""Largest share of the budget that is spent on finding out what matters."""
_TOLERANCE = 1e-2
"""Effects up to this part of what is at stake are not worth a dimension more of the search."""
_BASES = (4, 6)
"""How many base points, at least and at most, that takes."""


class NotFinite(DomainError):
    """Every rollout of a plan failed: a block of the domain computes nothing finite; the message names the first."""


@dataclass(frozen=True)
class SearchSettings:
    """What is the same for all searches of one plan.

    Attributes:
        midlevel: the task's optimiser and its budgets.
        rng: source of everything random.
        began: when the work began, by `time.monotonic` [s].
        tell: told how far the work is.
        compare: whether each action is optimised on its own as well.
    """

    midlevel: MidLevel
    rng: np.random.Generator
    began: float
    tell: Progress
    compare: bool


@dataclass(frozen=True)
class Searched:
    """What a search found.

    Attributes:
        objective: what was searched, with the reserves that were kept.
        screening: which variables matter.
        influence: what they change.
        apart: the point ``(d,)`` at which each action is best on its own; None if that was not asked.
        optimum: the best point.
        spent: rollouts that were made so far.
    """

    objective: Objective
    screening: Screening
    influence: Influence
    apart: FloatArray | None
    optimum: Optimum
    spent: int


def search_plan(settings: SearchSettings, objective: Objective, spent: int = 0) -> Searched:
    """Find out what matters, and search it.

    Args:
        settings: the settings.
        objective: of a plan of which at least one hyperparameter varies.
        spent: rollouts that were made before.

    Raises:
        NotFinite: every rollout failed.
    """
    varying = objective.space.varying
    return _search_line(settings, objective, spent) if len(varying) == 1 else _search_space(settings, objective, spent)


def _search_space(settings: SearchSettings, objective: Objective, spent: int) -> Searched:
    """Screen the variables, and search those that matter from the defaults or from each action's own best."""
    screened, screening = _screen(settings, objective)
    objective = screened.objective
    influence = find_influence(objective, screening, screened.rollouts[-1])
    spent += screening.evaluations
    apart = optimise_apart(objective, influence.own & set(screening.relevant)) if settings.compare else None
    _, optimum = _optimise(settings, objective, screening.relevant, _choose_start(objective, apart), spent)
    return Searched(objective, screening, influence, apart, optimum, spent + optimum.evaluations)


def _search_line(settings: SearchSettings, objective: Objective, spent: int) -> Searched:
    """Search one variable: a space of one dimension cannot shrink, and the search itself shows what it moves."""
    (name,) = objective.space.varying
    searched, optimum = _optimise(settings, objective, [name], objective.space.default, spent)
    # Of all that was searched: the last generation alone may lie where all are as good as each other.
    influence = Influence({name: find_moved_measures(searched.rollouts)}, frozenset([name]))
    effect = Effect(0.0, 0.0) if is_idle(searched.rollouts) else Effect(np.inf, np.inf)
    objective = searched.objective
    apart = optimise_apart(objective, influence.own) if settings.compare else None
    screening = Screening({name: effect}, Effect(0.0, 0.0), 0)
    return Searched(objective, screening, influence, apart, optimum, spent + optimum.evaluations)


def _screen(settings: SearchSettings, objective: Objective) -> tuple[Evaluator, Screening]:
    space = objective.space
    affordable = int(_SCREENING * settings.midlevel.evaluations / (4 * len(space.varying) + 1))
    bases = int(np.clip(affordable, *_BASES))
    evaluate = Evaluator(objective, space)
    try:
        return evaluate, screen_hyperparameters(evaluate, space, settings.rng, bases=bases, tolerance=_TOLERANCE)
    except NothingFinite as error:
        raise _blame_block(evaluate, error) from error


def _choose_start(objective: Objective, apart: FloatArray | None) -> FloatArray:
    """Return the point from which to search: the defaults, or where each action is the best on its own."""
    default = objective.space.default
    if apart is None or np.allclose(apart, default, rtol=1e-9):
        return default
    scores = objective(np.array([default, apart]))
    return (default, apart)[int(np.argmin(scores.ranks()))]


def _optimise(
    settings: SearchSettings, objective: Objective, names: Collection[str], start: FloatArray, spent: int
) -> tuple[Evaluator, Optimum]:
    """Search some variables from a point; the optimum's point is one of the whole space."""
    midlevel = settings.midlevel
    part = objective.space.starting_at(start).only(names)
    left = max(1, midlevel.evaluations - spent)
    seconds = max(0.1, midlevel.seconds - (time.monotonic() - settings.began))
    optimise = find_optimiser(midlevel.optimiser, batch=_BATCHES.get(midlevel.optimiser), quick=True)

    def tell(milestone: Milestone) -> None:
        share = max(milestone.evaluations / left, (time.monotonic() - settings.began) / midlevel.seconds)
        settings.tell(min(share, 1.0), milestone)

    evaluate = Evaluator(objective, part)
    try:
        optimum = optimise(evaluate, part, Budget(left, seconds), settings.rng, tell)
    except NothingFinite as error:
        raise _blame_block(evaluate, error) from error
    return evaluate, replace(optimum, point=part.embed(optimum.point[None])[0])


def _blame_block(evaluated: Evaluator, error: NothingFinite) -> NotFinite:
    """Name the block in which something first was not finite."""
    failed = evaluated.rollouts[-1].failed
    where = next((instance for instance in evaluated.objective.plan.instances if instance.name in failed), None)
    if where is None:
        return NotFinite([Issue("", str(error))])
    return NotFinite([Issue(where.name, str(error), remedy=f"there the block {where.block} first computed it")])
