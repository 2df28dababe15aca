"""The verb ``probe``: of which classes is a token a member, and the task file in which it is."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hybrid_tamp.errors import ExecutionFailed, InputError, Issue
from hybrid_tamp.model.membership import MembershipResult
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.questions.probe.membership import MOST_STARTS, STARTS, Prober, Tell
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.rewriting import with_members
from hybrid_tamp.taskfile.saving import write_checked
from hybrid_tamp.verbs.loading import Settings, domain_finder, load


def probe(
    source: Task | Path | str,
    token: str,
    classes: Sequence[str] = (),
    settings: Settings = Settings(),  # noqa: B008
    *,
    starts: int = STARTS,
    most_starts: int = MOST_STARTS,
    seconds: float | None = None,
    backend: str = "pybullet",
    tell: Tell = lambda share, what: None,
) -> MembershipResult:
    """Find out of which classes a token is a member, by predictions from its shape and by trials in physics.

    Args:
        source: a task, the path of a task file, or the name of a bundled task; its other tokens lend hands and
            labelled members.
        token: name of the token.
        classes: names of the classes to try; all that the token is unknown in by default.
        settings: what replaces what the file says; the seed draws the starts.
        starts: from how many starts each class is tried at first.
        most_starts: from how many at most, if fewer leave the verdict unsure.
        seconds: wall-clock time for everything [s]; unlimited by default.
        backend: name of the physics backend.
        tell: told how far the work is.

    Raises:
        InputError: the task file is wrong, there is no such token, class or backend, or nothing to find out.
        LimitReached: not done in time.
    """
    from hybrid_tamp.physics.protocol import open_backend

    deadline = float("inf") if seconds is None else time.monotonic() + seconds
    with PlannerProcess() as process, open_backend(backend) as physics:
        task = load(source, settings)

        def find_plan(trial: Task) -> TaskPlan:
            return plan_task(trial, process).required()

        prober = Prober(find_plan, physics, starts, most_starts, deadline=deadline, tell=tell)
        return prober.probe(task, token, classes, task.seed)


def save_members(
    source: Task | Path | str,
    result: MembershipResult,
    target: Path,
    settings: Settings = Settings(),  # noqa: B008
    *,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a task file in which the token is a member of the classes that were confirmed.

    Args:
        source: the task that was probed, or its file.
        result: the result of the probe.
        target: the new file.
        settings: those with which it was probed.
        force: whether the file is replaced if it is there already.

    Returns:
        The names of the classes that the token joins.

    Raises:
        ExecutionFailed: no class was confirmed.
        InputError: the file is there already or cannot be written, or the token cannot stay where it is as a member.
    """
    joined = [verdict for verdict in result.verdicts if verdict.verdict == "yes"]
    if not joined:
        said = ", ".join(f"{verdict.object_class}: {verdict.verdict}" for verdict in result.verdicts)
        raise ExecutionFailed(f"nothing is written: no class was confirmed of {result.token}; {said}")
    if target.is_dir() or (target.exists() and not force):
        remedy = "force=True replaces a file"
        raise InputError([Issue(str(target), "a new task file", "one that is there", remedy=remedy)])
    task = load(source, settings)
    assert task.source is not None, "a task that came from a file"
    names = tuple(verdict.object_class for verdict in joined)
    settled = [verdict.object_class for verdict in result.verdicts if verdict.verdict in ("yes", "no")]
    properties: dict[str, Any] = {}
    for verdict in joined:
        properties |= verdict.properties
    text = with_members(task.source, target, result.token, names, settled, properties)
    write_checked(target, text, lambda path: load_task(path, domain_finder(settings.domain)))
    return names
