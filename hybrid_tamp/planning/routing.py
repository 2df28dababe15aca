"""Evaluation of a plan in the forward models, with paths for movements that would hit bodies."""

import logging
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from hybrid_tamp.midlevel.refinement import evaluate_defaults
from hybrid_tamp.midlevel.rollout import Rollouts
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.refined import CLEAR, RefinedPlan, Shortfall
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.clearance import find_movements
from hybrid_tamp.planning.detours import find_detour

_LOG = logging.getLogger(__name__)

Evaluate = Callable[[TaskPlan, Rollouts], RefinedPlan]
"""Function of a plan and its rollouts that returns the plan with a value for every hyperparameter."""


def route(task: Task, plan: TaskPlan, evaluate: Evaluate, deadline: Deadline = NEVER) -> RefinedPlan:
    """Evaluate a plan, and add paths around the bodies that its movements hit, until no movement hits a body.

    If there is no path around a body, the shortfall of the result names the body.

    Args:
        task: task of the plan.
        plan: a valid plan of the task.
        evaluate: function that chooses the hyperparameters.
        deadline: deadline of the command.

    Raises:
        LimitReached: the deadline passes.
        NotFinite: every rollout failed.
    """
    while True:
        rollouts = Rollouts(task, plan, deadline)
        refined = evaluate(plan, rollouts)
        if refined.shortfall is not None:
            return refined
        for movement in find_movements(task, refined.plan, rollouts.trace(refined.plan), deadline):
            hit = movement.find_hit()
            if hit is not None:
                break
        else:
            return refined
        name, given = movement.instance.name, movement.instance.path
        path = None if given else find_detour(task, movement, _seed(task, name))
        if path is None:
            sought = task.domain.block_by_name[movement.instance.block].path is not None
            atom = Atom(CLEAR, (hit.moving, hit.other))
            return replace(refined, shortfall=Shortfall(name, atom, "m", hit.distance, detour=sought))
        _LOG.info("%s follows a path with %d corners, because %s would hit %s", name, len(path), hit.moving, hit.other)
        plan = plan.with_path(name, path)


def route_defaults(task: Task, plan: TaskPlan, deadline: Deadline = NEVER) -> RefinedPlan | None:
    """Route a plan with the default hyperparameters, whose other shortfalls do not matter.

    Args:
        task: task of the plan.
        plan: a valid plan of the task.
        deadline: deadline of the command.

    Returns:
        The routed plan. None if the plan moves every body, so that there is nothing to avoid.

    Raises:
        LimitReached: the deadline passes.
        NotFinite: every rollout failed.
    """
    if not _leaves_bodies(task, plan):
        return None
    return route(
        task, plan, lambda one, rolled: replace(evaluate_defaults(task, one, rolled), shortfall=None), deadline
    )


def _leaves_bodies(task: Task, plan: TaskPlan) -> bool:
    """Return whether the task has a body that no instance of the plan moves."""
    blocks = task.domain.block_by_name
    moved = {
        token
        for instance in plan.instances
        for slot, token in instance.slots.items()
        if blocks[instance.block].writes.get(slot)
    }
    return any(token.shape is not None and token.name not in moved for token in task.tokens)


def _seed(task: Task, name: str) -> int:
    """Return the seed of the query for one instance."""
    return int(np.random.SeedSequence([task.seed, *name.encode()]).generate_state(1)[0])
