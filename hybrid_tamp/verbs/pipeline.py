"""The story in one screen: task file -> task -> plan -> physics run -> documents.

Each function is one verb of the command line; the stages know nothing of each other.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.recording import Recording
from hybrid_tamp.model.refined import Milestone
from hybrid_tamp.model.run_result import RunResult
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.physics_rollouts import PhysicsRollouts
from hybrid_tamp.planning.plan import PlanOutcome, plan
from hybrid_tamp.planning.replanning import Rounds, plan_in_rounds
from hybrid_tamp.report.convergence import convergence_picture
from hybrid_tamp.report.documents import document
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.report.measures import run_measures
from hybrid_tamp.report.page import write_page
from hybrid_tamp.report.plan_entries import steps_of
from hybrid_tamp.report.refinement import refinement_entry
from hybrid_tamp.report.versions import versions
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.pddl.text import domain_text, plan_text, problem_text
from hybrid_tamp.symbolic.reencode import plan_actions
from hybrid_tamp.symbolic.strategies.search import Planner
from hybrid_tamp.taskfile.copying import portable
from hybrid_tamp.taskfile.domains import installed_domain
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.workers.processes import count_processors

__all__ = [
    "Progress",
    "RunOutcome",
    "check_video",
    "draw",
    "export",
    "judge",
    "plan",
    "refine",
    "replay",
    "run",
    "save_plan",
]

if TYPE_CHECKING:
    from hybrid_tamp.execution.replay import ReplayReport

Planning = Callable[[Task], PlanOutcome]
"""A way to a plan other than by a planner, e.g. by imitation."""
Progress = Callable[[float, str], None]
"""Called with the share done, 0 to 1, and what is being done."""


@dataclass(frozen=True)
class RunOutcome:
    """What came of a run."""

    plan: PlanOutcome
    recording: Recording
    document: RunResult


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

    Raises:
        InputError: the goal leaves a choice, and there is no plan that would make it.
    """
    if plan is not None and len(task.alternatives()) > 1:
        task = next(each for each in task.alternatives() if not check_law(each, plan))
    if encoding == "temporal":
        return _export_temporal(task, folder, plan)
    compilation = compile_task(task)
    problem = compilation.problem
    files = [
        folder.write_text("domain.pddl", domain_text(problem.domain)),
        folder.write_text("problem.pddl", problem_text(problem)),
    ]
    if plan is not None:
        files.append(folder.write_text("plan.pddl", plan_text(plan_actions(compilation, plan))))
    return files


def _export_temporal(task: Task, folder: RunFolder, plan: TaskPlan | None) -> list[Path]:
    from hybrid_tamp.symbolic.pddl.temporal_text import temporal_domain_text, temporal_plan_text, temporal_problem_text
    from hybrid_tamp.symbolic.temporal.compilation import compile_durative
    from hybrid_tamp.symbolic.temporal.reencoding import reencode_durative

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
    """Write a plan's document, convergence curve and PDDL, the task file and what it names, in place of another run's.

    A goal with a choice of which none was made has no PDDL, nor has one about a token of which too little is known.
    """
    # The task may be another run's, in this very folder.
    text, named = portable(outcome.task)
    folder.clear()
    for name, content in {"task.yaml": text, **named}.items():
        folder.write_text(name, content)
    folder.write_json("plan.json", outcome.document.dump())
    refinement = outcome.document.refinement
    curve = None if refinement is None else convergence_picture(refinement)
    if curve is not None:
        folder.write_bytes("convergence.png", curve)
    if outcome.plan is not None or outcome.task.definite:
        export(outcome.chosen or outcome.task, folder, outcome.plan)


def refine(
    task: Task,
    planner: Planner | None = None,
    progress: Progress | None = None,
    planning: Planning | None = None,
    *,
    backend: str = "pybullet",
    processes: int | None = None,
) -> Rounds:
    """Plan a task and optimise the hyperparameters of the whole plan; plan anew where none do.

    The document of the outcome has the optimised values, and how they were found.

    Args:
        task: the task.
        planner: a running planner process; without one, one is started for each round.
        progress: told how far the work is, and the best value so far.
        planning: how plans are found, if not by the planner.
        backend: name of the physics backend in which a task with ``refine: physics`` tries candidates.
        processes: how many it may use at once, by default one for each processor; the result does not depend on it.

    Raises:
        InputError: the planner or the backend is unknown.
        NotFinite: every rollout of a plan failed.
    """

    def tell(share: float, best: Milestone) -> None:
        if progress is not None:
            said = f"V {best.violation:.3g}" if best.violation > 0 else f"value {best.value:.4g}"
            progress(share, f"optimising: {said}")

    rounds = plan_in_rounds(
        task,
        planning or (lambda each: plan(each, planner)),
        tell,
        lambda each, found: PhysicsRollouts(each, found, backend, processes or count_processors()),
    )
    if rounds.refined is None:
        return rounds
    refined, outcome = rounds.refined, rounds.outcome
    given_up = [(each.instance.block, each.instance.roles, each.shortfall) for each in rounds.given_up]
    added = {"refinement": refinement_entry(refined, given_up), "steps": steps_of(refined.plan)}
    outcome = replace(outcome, plan=refined.plan, document=outcome.document.model_copy(update=added))
    return replace(rounds, outcome=outcome)


def run(
    task: Task,
    folder: RunFolder,
    *,
    planner: Planner | None = None,
    backend: str = "pybullet",
    video: Path | None = None,
    progress: Progress | None = None,
    planning: Planning | None = None,
) -> RunOutcome:
    """Plan a task, optimise its hyperparameters, carry the plan out, record it and judge the recording.

    Args:
        task: the task.
        folder: where the files of the run go.
        planner: a running planner process; without one, one is started for each round.
        backend: name of the physics backend.
        video: where the video goes; without it only one picture a step is drawn.
        progress: told how far the work is.
        planning: how plans are found, if not by the planner.

    Raises:
        NoPlan: there is no plan, or none was found that the forward models can carry out.
        LimitReached: the planner ran into a limit.
        InputError: the planner or the backend is unknown.
        NotFinite: every rollout of a plan failed.
    """
    from hybrid_tamp.execution.events import EventLog
    from hybrid_tamp.execution.loop import execute
    from hybrid_tamp.execution.storage import save
    from hybrid_tamp.physics.protocol import open_backend

    began = time.monotonic()
    tell = progress or (lambda share, what: None)
    check_video(video)
    with open_backend(backend) as physics:
        rounds = refine(task, planner, progress, planning, backend=backend)
        save_plan(rounds.outcome, folder)
        write_page(folder)  # of the plan, or of why there is none
        chosen = rounds.outcome.required()
        with EventLog(folder.path / "events.jsonl") as events:
            recording = execute(task, chosen, physics, lambda now, end: tell(min(now / end, 1.0), "running"), events)
    outcome = judge(task, rounds, recording, began)
    save(outcome.recording, folder.path / "recording.npz")
    folder.write_json("result.json", document(outcome.document))
    draw(task, outcome.recording, folder, video, tell)
    write_page(folder)
    return outcome


def judge(task: Task, rounds: Rounds, recording: Recording, began: float) -> RunOutcome:
    """Hold a recording against what was predicted, the law and the domain's measures.

    Args:
        task: the task.
        rounds: the plan that was run, refined.
        recording: what was measured.
        began: when the work began, on the monotonic clock [s].
    """
    from hybrid_tamp.execution.prediction import add_predictions
    from hybrid_tamp.midlevel.measured import measure_run

    assert rounds.refined is not None, "what was run was refined"
    recording = add_predictions(recording, rounds.refined.expected)
    metrics = {**(task.domain.metrics(task, recording) if task.domain.metrics else {})}
    metrics |= run_measures(rounds.outcome.required(), recording)
    figures = {key: float(figure[0]) for key, figure in measure_run(task, recording).figures.items()}
    result = RunResult(
        task,
        recording,
        replans=len(rounds.given_up),
        metrics={name: value for name, value in metrics.items() if isfinite(value)},
        wall_seconds=time.monotonic() - began,
        versions=versions(),
        performance=tuple(
            replace(each, measured=figures.get((each.instance, each.measure))) for each in rounds.refined.performance
        ),
        law=tuple([] if recording.failure else check_law(task, recording.plan, recording.at)),
    )
    return RunOutcome(rounds.outcome, recording, result)


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
    from hybrid_tamp.physics.pictures.rendering import open_renderer
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
    from hybrid_tamp.execution.replay import replay as run_again
    from hybrid_tamp.execution.storage import load
    from hybrid_tamp.physics.protocol import open_backend

    recording = load(directory / "recording.npz")
    task = load_task(directory / "task.yaml", find_domain)
    with open_backend(recording.backend) as physics:
        return run_again(task, recording, physics)
