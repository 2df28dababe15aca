"""From the words of the command line to a task."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from hybrid_tamp.cli.options import Objective, Optimiser, Refine

if TYPE_CHECKING:
    from hybrid_tamp.model.domain import Domain
    from hybrid_tamp.model.task import Task


def load(text: str, domain: str | None, *, plans: bool = False) -> "Task":
    """Load a task; code is imported only where the command line, not the file, names it.

    The planner that the file names is checked only where it is the one that plans.
    """
    from hybrid_tamp.symbolic.engines.registry import check_engine
    from hybrid_tamp.taskfile.loader import load_task

    return load_task(text, finder(domain), check_engine if plans else None)


def finder(name: str | None) -> "Callable[[str], Domain]":
    """Return how a task file's domain is found: as the command line says, else among the installed ones."""
    from hybrid_tamp.taskfile.domains import find_domain, installed_domain

    if name is None:
        return installed_domain
    chosen = find_domain(name)
    return lambda _: chosen


def adjusted(
    task: "Task",
    planner: str | None,
    objective: Objective | None,
    seed: int | None,
    time_limit: float | None,
    memory_limit: float | None,
) -> "Task":
    """Return the task with what the command line says in place of what the file says."""
    from dataclasses import replace

    limits = replace(
        task.limits,
        time=task.limits.time if time_limit is None else time_limit,
        memory=task.limits.memory if memory_limit is None else memory_limit,
    )
    return task.replaced(
        planner=planner or task.planner,
        objective=task.objective if objective is None else objective.value,
        seed=task.seed if seed is None else seed,
        limits=limits,
    )


def with_midlevel(task: "Task", optimiser: Optimiser | None, evaluations: int | None, refine: Refine | None) -> "Task":
    """Return the task whose hyperparameters are optimised as the command line says, else as the file says."""
    from dataclasses import replace

    own = task.midlevel
    midlevel = replace(
        own,
        optimiser=own.optimiser if optimiser is None else optimiser.value,
        evaluations=own.evaluations if evaluations is None else evaluations,
        refine=own.refine if refine is None else refine.value,
    )
    return task.replaced(midlevel=midlevel)
