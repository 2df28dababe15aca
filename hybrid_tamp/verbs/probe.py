"""Probing a token never seen: of which classes is it a member, and the task file in which it is."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hybrid_tamp.errors import ExecutionFailed, InputError, Issue
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan
from hybrid_tamp.questions.probe.membership import MOST_STARTS, STARTS, Prober, Tell
from hybrid_tamp.questions.probe.verdicts import ProbeReport, Verdict
from hybrid_tamp.symbolic.strategies.stage import Planner
from hybrid_tamp.taskfile.domains import installed_domain
from hybrid_tamp.taskfile.loader import FindDomain, load_task
from hybrid_tamp.taskfile.rewriting import with_members
from hybrid_tamp.taskfile.saving import write_checked

__all__ = ["probe", "probe_document", "save_members"]


def probe(
    task: Task,
    token: str,
    classes: Sequence[str] = (),
    *,
    starts: int = STARTS,
    most_starts: int = MOST_STARTS,
    seconds: float | None = None,
    backend: str = "pybullet",
    planner: Planner | None = None,
    tell: Tell = lambda share, what: None,
) -> ProbeReport:
    """Find out of which classes a token is a member, by predictions from its shape and by trials in physics.

    Args:
        task: the task; its other tokens lend hands and labelled members.
        token: name of the token.
        classes: names of the classes to try; all that the token is unknown in by default.
        starts: from how many starts each class is tried at first; the task's seed draws them.
        most_starts: from how many at most, where fewer leave the verdict unsure.
        seconds: wall-clock time for everything [s]; unlimited by default.
        backend: name of the physics backend.
        planner: a running planner process; without one, one is started for each plan.
        tell: told how far the work is.

    Raises:
        InputError: there is no such token, class or backend, or nothing to find out.
        LimitReached: not done in time.
    """
    from hybrid_tamp.physics.protocol import open_backend

    deadline = float("inf") if seconds is None else time.monotonic() + seconds
    with open_backend(backend) as physics:
        find_plan = lambda tried: plan(tried, planner).required()  # noqa: E731
        prober = Prober(find_plan, physics, starts, most_starts, deadline=deadline, tell=tell)
        return prober.probe(task, token, classes, task.seed)


def save_members(
    task: Task, report: ProbeReport, target: Path, *, force: bool = False, find_domain: FindDomain = installed_domain
) -> tuple[str, ...]:
    """Write a task file in which the token is a member of the classes that were confirmed.

    Args:
        task: the task that was probed; it came from a file.
        report: what came of it.
        target: the new file.
        force: whether the file may be there already.
        find_domain: how the domain is found that the file names.

    Returns:
        The names of the classes that the token joins.

    Raises:
        ExecutionFailed: no class was confirmed.
        InputError: the file is there already or cannot be written, or the token cannot stay where it is as a member.
    """
    joined = [verdict for verdict in report.verdicts if verdict.verdict == "yes"]
    if not joined:
        said = ", ".join(f"{verdict.object_class}: {verdict.verdict}" for verdict in report.verdicts)
        raise ExecutionFailed(f"nothing is written: no class was confirmed of {report.token}; {said}")
    if target.is_dir() or (target.exists() and not force):
        raise InputError([Issue(str(target), "a new task file", "one that is there", remedy="--force replaces a file")])
    assert task.source is not None, "it came from a file"
    names = tuple(verdict.object_class for verdict in joined)
    settled = [verdict.object_class for verdict in report.verdicts if verdict.verdict in ("yes", "no")]
    properties: dict[str, Any] = {}
    for verdict in joined:
        properties |= verdict.properties
    text = with_members(task.source, target, report.token, names, settled, properties)
    write_checked(target, text, lambda path: load_task(path, find_domain))
    return names


def probe_document(report: ProbeReport) -> dict[str, Any]:
    """Return what programs read."""
    return {
        "schema": "hybrid-tamp/probe/1",
        "task": report.task,
        "token": report.token,
        "seed": report.seed,
        "resting_faces": [pose.__dict__ for pose in report.resting],
        "classes": [_entry(verdict) for verdict in report.verdicts],
    }


def _entry(verdict: Verdict) -> dict[str, Any]:
    low, high = verdict.interval
    return {
        "class": verdict.object_class,
        "verdict": verdict.verdict,
        "likelihood": verdict.likelihood,
        "labelled": verdict.labelled,
        "residual": verdict.residual,
        "properties": dict(verdict.properties),
        "contacts": dict(verdict.contacts),
        "successes": verdict.successes,
        "trials": [{"success": t.success, "why": t.why, "measures": dict(t.measures)} for t in verdict.trials],
        "interval": [low, high],
        "obstacle": verdict.obstacle,
    }
