"""Entries of lists for users: bundled tasks, planning engines, and plans of several engines for one task."""

from dataclasses import dataclass
from pathlib import Path

from hybrid_tamp.model.outcome import Status
from hybrid_tamp.model.plan import Fewest


@dataclass(frozen=True)
class BundledTask:
    """A task file that is installed with the package.

    Attributes:
        name: name of the task.
        domain: name of the task's domain.
        description: description in one sentence, from the first comment of the file.
        path: path of the file.
    """

    name: str
    domain: str
    description: str
    path: Path


@dataclass(frozen=True)
class InstalledEngine:
    """A planning engine.

    Attributes:
        name: name of the engine, for ``--planner``.
        version: version of its package, or None if the engine cannot be used.
        remedy: command that makes the engine usable, or an empty string.
        length: what is known about the number of actions in its plans.
        proves: whether the engine proves that a task has no plan.
    """

    name: str
    version: str | None
    remedy: str
    length: Fewest
    proves: bool


@dataclass(frozen=True)
class EngineResult:
    """The result of one engine for a task.

    Attributes:
        planner: name of the engine.
        status: status of planning, or None if the engine does not accept the task.
        actions: number of actions of the plan, or None if there is no plan.
        makespan: duration of the plan [s], or None if there is no plan.
        seconds: duration of planning [s], or None if the engine does not accept the task.
        message: what is known about the length of the plan, or why there is no plan.
    """

    planner: str
    status: Status | None
    actions: int | None
    makespan: float | None
    seconds: float | None
    message: str
