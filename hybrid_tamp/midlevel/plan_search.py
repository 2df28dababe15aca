"""Search for the best hyperparameters of a plan.

Screening finds the variables that have an effect. All other variables keep their defaults, so that the search space is
smaller. The search starts at the default point or, if better, at the result of optimising each action separately.
"""

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

import numpy as np

from hybrid_tamp.errors import DomainError, Issue
from hybrid_tamp.midlevel.action_by_action import optimise_apart
from hybrid_tamp.midlevel.influence import Influence, find_influence, find_moved_measures, is_idle
from hybrid_tamp.midlevel.line_search import Rolled, search_line
from hybrid_tamp.midlevel.objective import Evaluator, Objective
from hybrid_tamp.midlevel.optimiser import Budget, NothingFinite, Optimum
from hybrid_tamp.midlevel.predictions import Rollout
from hybrid_tamp.midlevel.registry import find_optimiser
from hybrid_tamp.midlevel.screening import Effect, Screening, screen_hyperparameters
from hybrid_tamp.model.refined import Milestone
from hybrid_tamp.model.task import MidLevel
from hybrid_tamp.motion.arrays import FloatArray

Progress = Callable[[float, Milestone], None]
"""Progress callback. Its arguments are the used fraction of the budget (0 to 1) and the best candidate so far."""

_BATCHES = {"cma": 48}
"""Maps the name of an optimiser to its number of candidates per batch."""
_SCREENING = 0.4
"""Largest share of the budget for screening."""
_TOLERANCE = 1e-2
"""Largest negligible effect of a variable, as a fraction of the spread over all screened points."""
_BASES = (4, 6)
"""Minimum and maximum number of base points for screening."""


class NotFinite(DomainError):
    """Raised if every rollout of a plan fails. The message names the first block with a non-finite result."""


@dataclass(frozen=True)
class SearchSettings:
    """Settings of all searches for one plan.

    Attributes:
        midlevel: optimiser and budget of the task.
        rng: only source of randomness.
        tell: progress callback.
        compare: whether to also optimise each action separately.
    """

    midlevel: MidLevel
    rng: np.random.Generator
    tell: Progress
    compare: bool


@dataclass(frozen=True)
class Searched:
    """The result of a search.

    Attributes:
        objective: objective of the search, including its reserves.
        screening: result of the screening of the variables.
        influence: performance measures and actions that the variables affect.
        apart: point that results from optimising each action separately. Shape ``(d,)``. None if not computed.
        optimum: best point of the search.
        spent: total number of rollouts so far.
        whole: rollouts of the whole plan for all points of the search, or None if the rollouts covered only a part.
    """

    objective: Objective
    screening: Screening
    influence: Influence
    apart: FloatArray | None
    optimum: Optimum
    spent: int
    whole: Rolled | None = None


def search_plan(settings: SearchSettings, objective: Objective, spent: int = 0) -> Searched:
    """Search for the best values of the relevant hyperparameters.

    Args:
        settings: settings of the search.
        objective: objective of a plan with at least one hyperparameter that is not constant.
        spent: number of rollouts before this search.

    Raises:
        NotFinite: if every rollout failed.
    """
    varying = objective.space.varying
    return _search_line(settings, objective, spent) if len(varying) == 1 else _search_space(settings, objective, spent)


def _search_space(settings: SearchSettings, objective: Objective, spent: int) -> Searched:
    """Screen the variables, and search over the relevant variables."""
    screened, screening = _screen(settings, objective)
    objective = screened.objective
    influence = find_influence(objective, screening, screened.rollouts[-1])
    spent += screening.evaluations
    apart = optimise_apart(objective, influence.own & set(screening.relevant)) if settings.compare else None
    _, optimum = _optimise(settings, objective, screening.relevant, _choose_start(objective, apart), spent)
    return Searched(objective, screening, influence, apart, optimum, spent + optimum.evaluations)


def _search_line(settings: SearchSettings, objective: Objective, spent: int) -> Searched:
    """Search over a single variable without screening. The search itself shows the effects of the variable."""
    (name,) = objective.space.varying
    budget = Budget(max(1, settings.midlevel.evaluations - spent))

    def tell(milestone: Milestone) -> None:
        settings.tell(min(milestone.evaluations / budget.evaluations, 1.0), milestone)

    whole = Rolled(replace(objective, until=None))
    try:
        optimum, apart = _find_on_line(settings, whole, budget, tell)
    except NothingFinite as error:
        raise _blame_block(whole.objective, whole.rollouts[-1], error) from error
    # Use all batches, because all candidates of the last grid may be equally good.
    influence = Influence({name: find_moved_measures(whole.rollouts)}, frozenset([name]))
    effect = Effect(0.0, 0.0) if is_idle(whole.rollouts) else Effect(np.inf, np.inf)
    screening = Screening({name: effect}, Effect(0.0, 0.0), 0)
    return Searched(whole.objective, screening, influence, apart, optimum, spent + whole.count, whole)


def _find_on_line(
    settings: SearchSettings, whole: Rolled, budget: Budget, tell: Callable[[Milestone], None]
) -> tuple[Optimum, FloatArray | None]:
    """Return the optimum and, if requested, the point that results from optimising the action on its own."""
    if settings.midlevel.optimiser != "grid":
        return search_line(whole, budget, tell, settings.compare)
    # Direct sampling is a baseline, so it samples a single variable on one regular grid, too.
    part = whole.objective.space.only(whole.objective.space.varying)
    optimum = find_optimiser("grid")(whole, part, budget, settings.rng, tell)
    optimum = replace(optimum, point=part.embed(optimum.point[None])[0])
    return optimum, optimise_apart(whole.objective, part.names) if settings.compare else None


def _screen(settings: SearchSettings, objective: Objective) -> tuple[Evaluator, Screening]:
    space = objective.space
    affordable = int(_SCREENING * settings.midlevel.evaluations / (4 * len(space.varying) + 1))
    bases = int(np.clip(affordable, *_BASES))
    evaluate = Evaluator(objective, space)
    try:
        return evaluate, screen_hyperparameters(evaluate, space, settings.rng, bases=bases, tolerance=_TOLERANCE)
    except NothingFinite as error:
        raise _blame_block(objective, evaluate.rollouts[-1], error) from error


def _choose_start(objective: Objective, apart: FloatArray | None) -> FloatArray:
    """Return the default point or, if better, the point from optimising each action separately."""
    default = objective.space.default
    if apart is None or np.allclose(apart, default, rtol=1e-9):
        return default
    scores = objective(np.array([default, apart]))
    return (default, apart)[int(np.argmin(scores.ranks()))]


def _optimise(
    settings: SearchSettings, objective: Objective, names: Collection[str], start: FloatArray, spent: int
) -> tuple[Evaluator, Optimum]:
    """Search over the named variables from a start point. The optimum is returned as a point of the whole space."""
    midlevel = settings.midlevel
    part = objective.space.starting_at(start).only(names)
    left = max(1, midlevel.evaluations - spent)
    optimise = find_optimiser(midlevel.optimiser, batch=_BATCHES.get(midlevel.optimiser), quick=True)

    def tell(milestone: Milestone) -> None:
        settings.tell(min(milestone.evaluations / left, 1.0), milestone)

    evaluate = Evaluator(objective, part)
    try:
        optimum = optimise(evaluate, part, Budget(left), settings.rng, tell)
    except NothingFinite as error:
        raise _blame_block(objective, evaluate.rollouts[-1], error) from error
    return evaluate, replace(optimum, point=part.embed(optimum.point[None])[0])


def _blame_block(objective: Objective, rollout: Rollout, error: NothingFinite) -> NotFinite:
    """Return an error that names the first block with a non-finite result."""
    where = next((instance for instance in objective.plan.instances if instance.name in rollout.failed), None)
    if where is None:
        return NotFinite([Issue("", str(error))])
    remedy = f"check the forward model of {where.block}: block {where.block} has the first non-finite result"
    return NotFinite([Issue(where.name, str(error), remedy=remedy)])
