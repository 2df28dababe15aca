"""Entry point of the mid-level planner, which optimises all hyperparameters of a plan together (paper, Sec. II-D).

The planner keeps the defaults if the defaults meet all conditions and the plan has no performance measure. Otherwise,
the planner screens the hyperparameters and searches over the relevant hyperparameters. If the task requests refinement
in physics, the optimum is then refined in physics. On the forward models, the optimum is never worse than the defaults
and never worse than the result of optimising each action separately.
"""

import logging
import time
from collections.abc import Collection
from dataclasses import replace

import numpy as np

from hybrid_tamp.midlevel.nearby import sample_nearby
from hybrid_tamp.midlevel.objective import Objective, RollOut, find_last_measured
from hybrid_tamp.midlevel.physics_refinement import refine_in_physics
from hybrid_tamp.midlevel.plan_search import Progress, Searched, SearchSettings, search_plan
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.midlevel.summary import Candidates, summarise, summarise_defaults, summarise_nearby
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.refined import RefinedPlan
from hybrid_tamp.model.task import Task

_LOG = logging.getLogger(__name__)


_PROMISING = 0.5
"""Largest violation of a point near the defaults, as a fraction of their violation, after which the search goes on."""


def refine(
    task: Task,
    plan: TaskPlan,
    progress: Progress | None = None,
    roll_out: RollOut | None = None,
    compare: bool = True,
    measured: RollOut | None = None,
    nearby: Collection[str] = (),
    deadline: Deadline = NEVER,
) -> RefinedPlan:
    """Optimise the hyperparameters of a plan with the settings of its task.

    Args:
        task: task of the plan. The goal must name all tokens, without ``ANY``.
        plan: a valid plan of the task.
        progress: progress callback.
        roll_out: function that rolls out candidates. By default, the blocks' forward models are used.
        compare: whether to also optimise each action separately, for comparison.
        measured: function that runs candidates in physics, for tasks with ``refine: physics``.
        nearby: names of instances. If there is no value to maximise, points that differ from the defaults in one
            hyperparameter of these instances are tried first. If none of them halves the violation, nothing else is
            tried.
        deadline: deadline of the command.

    Raises:
        LimitReached: if the deadline passes.
        NotFinite: if every rollout failed.
    """
    began, last = time.monotonic(), find_last_measured(task, plan)
    objective = Objective(task, plan, roll_out or Rollouts(task, plan, deadline))
    valued = last is not None or task.midlevel.objective == "distance"
    if not valued or not objective.space.varying:
        defaults = Candidates.of(objective, objective.space.default)
        if not objective.space.varying or defaults.violation == 0:
            return summarise_defaults(objective, defaults, time.monotonic() - began)
    if not valued:
        objective = replace(objective, reserves={})  # Without a value to maximise, reserves have no use.
        settled = _try_nearby(objective, defaults, nearby, began) if nearby else None
        if settled is not None:
            return settled
    tell = progress or (lambda share, best: None)
    rng = np.random.default_rng(task.seed)
    settings = SearchSettings(task.midlevel, rng, tell, compare and last is not None)
    searched = search_plan(settings, replace(objective, until=last))
    candidates = _compare(searched)
    if last is not None and searched.optimum.violation == 0 and candidates.violation > 0:
        # The rollouts of the search stopped after the last measure, but a later condition is violated. Search again.
        searched = search_plan(settings, replace(searched.objective, until=None), searched.spent)
        candidates = _compare(searched)
    refined = None
    if measured is not None and task.midlevel.refine == "physics" and searched.screening.relevant:
        refined = refine_in_physics(settings, searched, candidates.point, Objective(task, plan, measured))
        candidates = candidates.replace_best(searched.objective, refined.point)
    found = summarise(searched, candidates, refined, time.monotonic() - began)
    optimised = f"{len(searched.screening.relevant)} of {len(found.hyperparameters)} hyperparameters"
    _LOG.info("%s optimised %s in %d rollouts, %.2f s", found.optimiser, optimised, found.evaluations, found.seconds)
    return found


def _try_nearby(
    objective: Objective, defaults: Candidates, nearby: Collection[str], began: float
) -> RefinedPlan | None:
    """Return the plan with a point near the defaults that meets all conditions, or with the defaults if none helps.

    The result is None if a search over the whole space may help.
    """
    points, scores = sample_nearby(objective, nearby)
    if (scores.violation == 0.0).any():
        candidates = Candidates.of(objective, points[0], points[np.argmin(scores.violation)])
        return summarise_nearby(objective, candidates, len(points), time.monotonic() - began)
    if scores.violation.min() > _PROMISING * scores.violation[0]:
        return summarise_defaults(objective, defaults, time.monotonic() - began)
    return None


def evaluate_defaults(task: Task, plan: TaskPlan, roll_out: RollOut) -> RefinedPlan:
    """Return the refined plan with the default hyperparameters, without a search and without its duration.

    Args:
        task: task of the plan.
        plan: a valid plan of the task.
        roll_out: function that rolls out candidates.

    Raises:
        LimitReached: if the deadline passes.
        NotFinite: if the rollout failed.
    """
    objective = Objective(task, plan, roll_out)
    return summarise_defaults(objective, Candidates.of(objective, objective.space.default), 0.0)


def _compare(searched: Searched) -> Candidates:
    """Roll out the whole plan for the defaults, the optimum and the result of optimising each action separately."""
    others = [] if searched.apart is None else [searched.apart]
    points = np.array([searched.objective.space.default, searched.optimum.point, *others])
    if searched.whole is None:
        return Candidates.of(searched.objective, *points)
    searched.whole.roll_out(points)  # The points of a line search were rolled out before.
    return Candidates.choose(searched.objective, searched.whole.look_up(points), points)
