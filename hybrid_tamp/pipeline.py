"""The story in one screen: task file -> task -> plan -> physics run -> documents.

Each function is one verb of the command line; the stages know nothing of each other.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from hybrid_tamp.affordances.explanation import Explanation, explain, explain_wholly
from hybrid_tamp.errors import HybridTampError, InputError, Issue, LimitReached, NoPlan
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.task import Task
from hybrid_tamp.report.documents import (
    ExplanationEntry,
    PlanDocument,
    PlannerEntry,
    ReasonEntry,
    ResultDocument,
    SuggestionEntry,
    plan_document,
    result_document,
)
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.report.measures import run_measures
from hybrid_tamp.report.versions import versions
from hybrid_tamp.symbolic.pddl import domain_text, problem_text
from hybrid_tamp.symbolic.planner import PlannerProcess
from hybrid_tamp.symbolic.problem import compile_task
from hybrid_tamp.symbolic.stage import Planned, Planner, plan_task
from hybrid_tamp.taskfile.copying import portable
from hybrid_tamp.taskfile.domains import installed_domain
from hybrid_tamp.taskfile.loader import load_task

if TYPE_CHECKING:
    from hybrid_tamp.physics.replay import ReplayReport

Progress = Callable[[float, str], None]
"""Called with the share done, 0 to 1, and what is being done."""

SUGGESTING = 4.0
"""How long `plan` looks for a single change with which there would be a plan [s]."""

_SAID = {
    "unsolvable": "No plan exists; the planner has proven it.",
    "not_found": "The planner found no plan, but has not proven that there is none.",
    "planner_crashed": "The planner crashed.",
    "plan_refused": "The planner returned a plan that is wrong; it was refused.",
}


@dataclass(frozen=True)
class PlanOutcome:
    """What came of planning: the document that is shown, and the plan where there is one."""

    task: Task
    document: PlanDocument
    plan: TaskPlan | None
    error: HybridTampError | None

    def required(self) -> TaskPlan:
        """Return the plan.

        Raises:
            NoPlan: there is none, or none was found.
            LimitReached: the planner ran into a limit.
        """
        if self.plan is None:
            raise self.error or NoPlan("no plan", proven=False, kind="not_found")
        return self.plan


@dataclass(frozen=True)
class RunOutcome:
    """What came of a run."""

    plan: PlanOutcome
    recording: Recording
    document: ResultDocument


def plan(task: Task, planner: Planner | None = None, suggesting: float = SUGGESTING) -> PlanOutcome:
    """Plan a task and judge the plan.

    Args:
        task: the task.
        planner: a running planner process; without one, one is started for this call.
        suggesting: how long to look for a single change that gives a plan, where there is none [s].

    Raises:
        InputError: the engine is unknown or not installed.
    """
    if planner is None:
        with PlannerProcess() as process:
            return plan(task, process, suggesting)
    began = time.monotonic()
    try:
        planned = plan_task(task, planner)
    except LimitReached as limit:
        entry = PlannerEntry(name=task.planner, seconds=time.monotonic() - began)
        said = ExplanationEntry(kind=limit.limit, message=str(limit), reasons=[])
        document = plan_document(task, status="limit", planner=entry, plan=None, explanation=said)
        return PlanOutcome(task, document, None, limit)
    return _outcome(task, planned, suggesting)


def _outcome(task: Task, planned: Planned, suggesting: float) -> PlanOutcome:
    answer = planned.answer
    entry = PlannerEntry(
        name=answer.engine,
        seconds=answer.seconds,
        way=planned.way,
        proven_shortest=planned.proven,
        stages=dict(planned.stages),
    )
    if planned.plan is not None:
        document = plan_document(task, status="solved", planner=entry, plan=planned.plan, explanation=None)
        return PlanOutcome(task, document, planned.plan, None)
    proven = planned.status == "unsolvable"
    detail = planned.refusal or ("" if proven else answer.message)
    said = " ".join(filter(None, [_SAID[planned.status], detail]))
    if detail:
        explanation = ExplanationEntry(kind=planned.status, message=said, reasons=[])
    else:
        explanation = _explanation(task, planned.status, said, proven, suggesting)
    status: Literal["unsolvable", "unknown"] = "unsolvable" if proven else "unknown"
    document = plan_document(task, status=status, planner=entry, plan=None, explanation=explanation)
    message = "\n".join([said, *(f"  {reason.goal}: {reason.message}" for reason in explanation.reasons)])
    return PlanOutcome(task, document, None, NoPlan(message, proven=proven, kind=planned.status))


def _explanation(task: Task, kind: str, said: str, proven: bool, suggesting: float) -> ExplanationEntry:
    """Return why there is no plan; single changes are looked for where that is proven and there is time for it."""
    if proven and suggesting:
        return explanation_entry(explain_wholly(task, suggesting, most=1), kind, said)
    return explanation_entry(Explanation(tuple(explain(task, proven)), (), complete=False), kind, said)


def explanation_entry(found: Explanation, kind: str, said: str) -> ExplanationEntry:
    """Return an explanation as data."""
    suggestions = [
        SuggestionEntry(
            kind=each.change.kind, what=each.change.what, length=each.length, names=[n for n in each.change.key if n]
        )
        for each in found.suggestions
    ]
    return ExplanationEntry(
        kind=kind,
        message=said,
        reasons=[ReasonEntry(**reason.__dict__) for reason in found.reasons],
        suggestions=suggestions,
        all_looked_at=found.complete,
    )


def export(
    task: Task,
    folder: RunFolder,
    plan: TaskPlan | None = None,
    encoding: Literal["classical", "temporal"] = "classical",
) -> list[Path]:
    """Write the PDDL of a task, and of its plan where given, for other planners.

    Args:
        task: the task.
        folder: where the files go.
        plan: a plan of it, whatever encoding it was found in.
        encoding: slot by slot without time, or one durative action a block.
    """
    if encoding == "temporal":
        return _export_temporal(task, folder, plan)
    problem = compile_task(task).problem
    files = [
        folder.write_text("domain.pddl", domain_text(problem.domain)),
        folder.write_text("problem.pddl", problem_text(problem)),
    ]
    if plan is not None:
        files.append(folder.write_text("plan.pddl", "".join(f"{line}\n" for line in plan.actions)))
    return files


def _export_temporal(task: Task, folder: RunFolder, plan: TaskPlan | None) -> list[Path]:
    from hybrid_tamp.symbolic.temporal.compilation import compile_durative
    from hybrid_tamp.symbolic.temporal.reencoding import reencode_durative
    from hybrid_tamp.symbolic.temporal.text import temporal_domain_text, temporal_plan_text, temporal_problem_text

    compilation = compile_durative(task)
    problem, actions = (compilation.problem, ()) if plan is None else reencode_durative(compilation, plan)
    files = [
        folder.write_text("domain.pddl", temporal_domain_text(problem.domain)),
        folder.write_text("problem.pddl", temporal_problem_text(problem)),
    ]
    if plan is not None:
        files.append(folder.write_text("plan.pddl", temporal_plan_text(actions)))
    return files


def save_plan(outcome: PlanOutcome, folder: RunFolder) -> None:
    """Write a plan's document and PDDL files, the task file and what it names, in place of another run's."""
    # The task may be another run's, in this very folder.
    text, named = (None, {}) if outcome.task.source is None else portable(outcome.task.source)
    folder.clear()
    for name, content in {**({} if text is None else {"task.yaml": text}), **named}.items():
        folder.write_text(name, content)
    folder.write_json("plan.json", outcome.document.dump())
    export(outcome.task, folder, outcome.plan)


def run(
    task: Task,
    folder: RunFolder,
    *,
    planner: Planner | None = None,
    backend: str = "pybullet",
    video: Path | None = None,
    progress: Progress | None = None,
) -> RunOutcome:
    """Plan a task, carry the plan out, record it and judge the recording.

    Args:
        task: the task.
        folder: where the files of the run go.
        planner: a running planner process; without one, one is started for this call.
        backend: name of the physics backend.
        video: where the video goes; without it only one picture a step is drawn.
        progress: told how far the work is.

    Raises:
        NoPlan: there is no plan, or none was found.
        LimitReached: the planner ran into a limit.
        InputError: the planner or the backend is unknown.
    """
    from hybrid_tamp.physics.backend import open_backend
    from hybrid_tamp.physics.events import EventLog
    from hybrid_tamp.physics.execution import execute
    from hybrid_tamp.physics.prediction import predict, with_predictions
    from hybrid_tamp.physics.storage import save

    began = time.monotonic()
    tell = progress or (lambda share, what: None)
    check_video(video)
    with open_backend(backend) as physics:
        outcome = plan(task, planner)
        save_plan(outcome, folder)
        chosen = outcome.required()
        with EventLog(folder.path / "events.jsonl") as events:
            measured = execute(task, chosen, physics, lambda now, end: tell(min(now / end, 1.0), "running"), events)
    recording = with_predictions(measured, predict(task, chosen))
    save(recording, folder.path / "recording.npz")
    metrics = task.domain.metrics(task, recording) if task.domain.metrics else {}
    metrics = {**metrics, **run_measures(chosen, recording)}
    breaches = [] if recording.failure else check_law(task, recording.plan, recording.at)
    document = result_document(
        task,
        recording,
        wall_seconds=time.monotonic() - began,
        metrics=metrics,
        versions=versions(),
        law=map(str, breaches),
    )
    folder.write_json("result.json", document.dump())
    draw(task, recording, folder, video, tell)
    return RunOutcome(outcome, recording, document)


def check_video(path: Path | None) -> None:
    """Refuse a video that could not be written, before anything is done.

    Raises:
        InputError: its folder is not there, or it does not end in ``.mp4``.
    """
    if path is None:
        return
    if path.suffix.lower() != ".mp4":
        raise InputError([Issue(str(path), "a video file that ends in .mp4")])
    if path.parent.exists() and not path.parent.is_dir():
        raise InputError([Issue(str(path), "a video file in a folder", f"{path.parent}, a file")])
    if not path.parent.exists():
        raise InputError([Issue(str(path), "a video file in a folder that exists", f"{path.parent}, which does not")])


def draw(task: Task, recording: Recording, folder: RunFolder, video: Path | None, tell: Progress) -> None:
    """Draw one picture a step, and the video where one is wanted."""
    from hybrid_tamp.physics.rendering import open_renderer
    from hybrid_tamp.report.video import step_pictures, write_video

    with open_renderer(task, recording) as renderer:
        step_pictures(folder.path, task, recording, renderer.picture)
        if video is not None:
            write_video(video, task, recording, renderer.picture, lambda done, of: tell(done / of, "drawing"))


def replay(directory: Path, find_domain: Callable[[str], Domain] = installed_domain) -> "ReplayReport":
    """Run the commands of a recording again and compare, bit for bit.

    Args:
        directory: the folder that a run left.
        find_domain: how the domain is found that the task file names.

    Raises:
        InputError: the folder holds no run, or a broken one; the message says what is wrong with it.
    """
    from hybrid_tamp.physics.backend import open_backend
    from hybrid_tamp.physics.replay import replay as run_again
    from hybrid_tamp.physics.storage import load

    recording = load(directory / "recording.npz")
    task = load_task(directory / "task.yaml", find_domain)
    with open_backend(recording.backend) as physics:
        return run_again(task, recording, physics)
