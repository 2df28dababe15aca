"""The verb ``probe``: find the classes of a token and write a task file with the confirmed classes."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from hybrid_tamp.errors import ExecutionFailed, InputError, Issue
from hybrid_tamp.model.membership import MembershipResult
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.planning.safety import blame_factors
from hybrid_tamp.questions.explain.no_plan import explain_failure
from hybrid_tamp.questions.probe.membership import MOST_STARTS, STARTS, Prober, Tell
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.taskfile.rewriting import with_members
from hybrid_tamp.taskfile.saving import write_checked
from hybrid_tamp.verbs.loading import Settings, domain_finder, load, load_timed


def probe(
    source: Task | Path | str,
    token: str,
    classes: Sequence[str] = (),
    settings: Settings = Settings(),  # noqa: B008
    *,
    starts: int = STARTS,
    most_starts: int = MOST_STARTS,
    backend: str = "pybullet",
    tell: Tell = lambda share, what: None,
) -> MembershipResult:
    """Find the classes of a token by predictions from its shape and by trials in physics.

    Args:
        source: a task, the path of a task file, or the name of a bundled task. Trials also use the task's other tokens.
        token: name of the token.
        classes: names of the classes to test; by default all classes whose membership is unknown.
        settings: settings that override the task file. The seed determines the initial states of the trials.
        starts: initial number of trials for each class. Each trial has a different initial state.
        most_starts: maximum number of trials for each class. Trials are added until the verdict is clear.
        backend: name of the physics backend.
        tell: called with the completed fraction of the work and the name of the current activity.

    Raises:
        InputError: the task file is wrong, the token, a class or the backend does not exist, or the token has no
            unknown classes.
        LimitReached: the time limit was reached.
    """
    from hybrid_tamp.physics.protocol import open_backend

    with PlannerProcess() as process, open_backend(backend) as physics:
        task, deadline = load_timed(source, settings)

        def find_plan(trial: Task) -> TaskPlan:
            outcome = blame_factors(plan_task(trial, process, deadline), process, deadline)
            if outcome.plan is None:
                outcome = replace(outcome, explanation=explain_failure(outcome))
            return outcome.required()

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
    """Write a task file in which the token has the confirmed classes.

    Args:
        source: the probed task, or its file or name.
        result: the result of the probe.
        target: the new file.
        settings: the settings of the probe.
        force: whether to replace an existing file.

    Returns:
        The names of the classes that the token joins.

    Raises:
        ExecutionFailed: no class was confirmed.
        InputError: the file exists or cannot be written, or a confirmed class does not allow the token's pose.
    """
    joined = [verdict for verdict in result.verdicts if verdict.verdict == "yes"]
    if not joined:
        said = ", ".join(f"{verdict.object_class}: {verdict.verdict}" for verdict in result.verdicts)
        raise ExecutionFailed(f"no file was written, because no class of {result.token} was confirmed; {said}")
    if target.is_dir() or (target.exists() and not force):
        remedy = "force=True replaces the existing file"
        raise InputError([Issue(str(target), "the new task file must not exist yet", remedy=remedy)])
    task = load(source, settings)
    assert task.source is not None, "the task must come from a file"
    names = tuple(verdict.object_class for verdict in joined)
    settled = [verdict.object_class for verdict in result.verdicts if verdict.verdict in ("yes", "no")]
    properties = {name: value for verdict in joined for name, value in verdict.properties.items()}
    text = with_members(task.source, target, result.token, names, settled, properties)
    write_checked(target, text, lambda path: load_task(path, domain_finder(settings.domain)))
    return names
