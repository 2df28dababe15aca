"""Load tasks with settings that override the task file."""

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.simulated import pass_simulator
from hybrid_tamp.model.task import Limits, MidLevel, Task
from hybrid_tamp.physics.protocol import SIMULATOR, open_backend
from hybrid_tamp.symbolic.engines.registry import check_engine
from hybrid_tamp.taskfile.domains import find_domain
from hybrid_tamp.taskfile.loader import load_task

_LOG = logging.getLogger(__name__)

Record = TypeVar("Record", Task, Limits, MidLevel)


@dataclass(frozen=True)
class Settings:
    """Settings that override a task file. A value of None keeps the file's setting.

    Attributes:
        domain: name of an installed domain, ``package.module:ATTRIBUTE`` or a Python file.
        planner: name of the planning engine.
        objective: what the planner minimises, ``length`` or ``makespan``.
        seed: seed of all random numbers.
        time_limit: time limit of the whole command [s].
        memory_limit: memory limit of the planner [MiB].
        optimiser: optimiser of hyperparameters, ``cma`` or ``grid``.
        evaluations: largest number of rollouts of the optimiser.
        refine: ``physics`` to continue the optimisation in the physics backend, or ``none``.
        began: reading of the monotonic clock when the command began [s]; by default when the verb is called.
    """

    domain: str | None = None
    planner: str | None = None
    objective: str | None = None
    seed: int | None = None
    time_limit: float | None = None
    memory_limit: float | None = None
    optimiser: str | None = None
    evaluations: int | None = None
    refine: str | None = None
    began: float | None = None

    def clock(self) -> float:
        """Return the reading of the monotonic clock when the command began [s]. Each verb first calls this method."""
        return time.monotonic() if self.began is None else self.began


def load(source: Task | Path | str, settings: Settings = Settings(), *, plans: bool = False) -> Task:
    """Load a task.

    Only the settings may name a module or Python file as the domain, because a task file must not name code.

    Args:
        source: a task, the path of a task file, or the name of a bundled task.
        settings: settings that override the task file.
        plans: whether the verb plans the task. If true, and if the settings name no planner, check that the planner in
            the task file is available.

    Raises:
        InputError: the file has faults; each issue names the place of a fault.
    """
    task = load_task(source, domain_finder(settings.domain), check_engine if plans and not settings.planner else None)
    _LOG.info("read the task %s: %d tokens of the domain %s", task.name, len(task.tokens), task.domain.name)
    limits = _replaced(task.limits, time=settings.time_limit, memory=settings.memory_limit)
    midlevel = _replaced(
        task.midlevel, optimiser=settings.optimiser, evaluations=settings.evaluations, refine=settings.refine
    )
    own = {"planner": settings.planner, "objective": settings.objective, "seed": settings.seed}
    return pass_simulator(_replaced(task, limits=limits, midlevel=midlevel, **own), partial(open_backend, SIMULATOR))


def load_timed(source: Task | Path | str, settings: Settings, *, plans: bool = False) -> tuple[Task, Deadline]:
    """Load a task as `load` does, and return the task with the deadline of the command.

    Raises:
        InputError: the file has faults; each issue names the place of a fault.
    """
    began = settings.clock()
    task = load(source, settings, plans=plans)
    return task, Deadline.after(task.limits.time, began)


def _replaced(record: Record, **values: Any) -> Record:
    """Return a copy of a record with new values, or the same record if no value changes. None keeps the old value."""
    changed = {name: value for name, value in values.items() if value not in (None, getattr(record, name))}
    return replace(record, **changed) if changed else record


def domain_finder(name: str | None) -> Callable[[str], Domain] | None:
    """Return the function that always finds the domain of this name, or None for the default of `load_task`."""
    if name is None:
        return None
    chosen = find_domain(name)
    return lambda _: chosen
