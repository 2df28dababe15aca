"""The verb ``run``: plan a task, optimise the plan, execute the plan in physics and evaluate the recorded run."""

import time
from contextlib import ExitStack
from functools import partial
from pathlib import Path

from hybrid_tamp.execution.events import EventLog
from hybrid_tamp.execution.execute import execute
from hybrid_tamp.execution.storage import save
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.expectation import Expectations
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.run_result import RunResult
from hybrid_tamp.model.task import Task
from hybrid_tamp.physics.protocol import open_backend
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.planning.replanning import FindPlan, Progress, plan_and_refine
from hybrid_tamp.planning.safety import blame_factors
from hybrid_tamp.questions.explain.no_plan import explain_outcome
from hybrid_tamp.report.documents import document
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.report.frame_size import SIZE
from hybrid_tamp.report.page import write_page
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.strategies.search import Planner
from hybrid_tamp.verbs.drawing import Films, draw_run
from hybrid_tamp.verbs.judging import compare_runs, judge
from hybrid_tamp.verbs.loading import Settings, load
from hybrid_tamp.verbs.movements import draw_into
from hybrid_tamp.verbs.plan import TRIALS, save_plan


def run(
    source: Task | Path | str,
    folder: RunFolder | Path | str,
    settings: Settings = Settings(),  # noqa: B008
    *,
    backend: str = "pybullet",
    video: Path | None = None,
    gif: Path | None = None,
    size: tuple[int, int] = SIZE,
    force: bool = False,
    compare: bool = False,
    planner: Planner | None = None,
    find_plan: FindPlan | None = None,
    progress: Progress | None = None,
    deadline: Deadline | None = None,
) -> RunResult:
    """Plan a task, optimise the plan's hyperparameters, execute the plan and evaluate the recorded run.

    Args:
        source: a task, the path of a task file, or the name of a bundled task.
        folder: folder for the files of the run.
        settings: settings that override the task file.
        backend: name of the physics backend.
        video: file for a video. One picture per step is drawn even if no video is wanted.
        gif: file for an animated GIF of at most 3 MB.
        size: width and height of the step pictures and the video [pixels].
        force: whether to replace the files of another run.
        compare: whether to run the plan with default hyperparameters too, and to compare the values of both runs.
        planner: a running planner process; by default a new process is started.
        find_plan: function that returns a plan; by default the planner is called.
        progress: called with the completed fraction of the work and the name of the current activity.
        deadline: deadline of a command that began earlier; by default the time limit of the task counts from now.

    Raises:
        NoPlan: there is no plan, or every plan that was found fails in the forward models.
        LimitReached: a time or memory limit was reached. The folder contains the results so far.
        InputError: the task file, the folder, the planner or the backend cannot be used.
        NotFinite: every rollout of a plan failed.
    """
    began, films = settings.clock(), Films(video, gif, size)
    tell = progress or (lambda share, what: None)
    with ExitStack() as stack:
        # Start the planner process first, so that its start-up overlaps with the reading of the task file.
        process = planner or stack.enter_context(PlannerProcess())
        task = load(source, settings, plans=find_plan is None)
        deadline = deadline or Deadline.after(task.limits.time, began)
        target = RunFolder.open(folder, force=force)
        films.check()
        physics = stack.enter_context(open_backend(backend))
        planning = find_plan or partial(plan_task, planner=process, deadline=deadline, expectations=Expectations())
        outcome = _plan(task, planning, process, tell, backend, deadline)
        save_plan(outcome, target)
        try:
            draw_into(target, outcome, deadline)
        finally:
            write_page(target, task.domain.resting)  # shows the plan, or the reasons why there is no plan
        plan = outcome.required()
        with EventLog(target.path / "events.jsonl") as events:
            recording = execute(task, plan, physics, partial(_tell, tell, "running"), events, deadline)
        compared = compare_runs(outcome, recording, physics, deadline) if compare else ()
    result = judge(outcome, recording, time.monotonic() - began, compared)
    _store(target, result, films, tell, deadline)
    return result


def _store(folder: RunFolder, result: RunResult, films: Films, tell: Progress, deadline: Deadline) -> None:
    """Write the recording, the result and the pictures, and then the page that shows them."""
    save(result.recording, folder.path / "recording.npz")
    folder.write_json("result.json", document(result))
    try:
        draw_run(folder, result.task, result.recording, films, partial(_tell, tell, "drawing"), deadline)
    finally:
        write_page(folder, result.task.domain.resting)


def _plan(
    task: Task, find_plan: FindPlan, planner: Planner, tell: Progress, backend: str, deadline: Deadline
) -> PlanOutcome:
    """Return the plan with optimised hyperparameters, or the reasons why there is no plan."""
    outcome = plan_and_refine(task, find_plan, tell, backend, deadline=deadline)
    if outcome.plan is not None:
        return outcome
    return explain_outcome(blame_factors(outcome, planner, deadline), TRIALS, 1, deadline)


def _tell(tell: Progress, what: str, done: float, of: float) -> None:
    tell(min(done / of, 1.0), what)
