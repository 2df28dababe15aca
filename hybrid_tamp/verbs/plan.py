"""The verb ``plan``: find and check a plan of a task, or explain why there is no plan."""

from contextlib import ExitStack
from functools import partial
from pathlib import Path

from hybrid_tamp.model.expectation import Expectations
from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.planning.replanning import Progress, avoid_collisions, plan_and_refine
from hybrid_tamp.planning.safety import blame_factors
from hybrid_tamp.questions.explain.no_plan import explain_outcome
from hybrid_tamp.report.convergence import convergence_picture
from hybrid_tamp.report.documents import document
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.report.swept.file import check_picture
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.strategies.search import Planner
from hybrid_tamp.taskfile.copying import portable
from hybrid_tamp.verbs.loading import Settings, load_timed
from hybrid_tamp.verbs.movements import draw_into, draw_plan
from hybrid_tamp.verbs.pddl import export

TRIALS = 6
"""Default maximum number of changed tasks to try, in the search for a change that makes the task solvable."""


def plan(
    source: Task | Path | str,
    settings: Settings = Settings(),  # noqa: B008
    *,
    folder: RunFolder | Path | str | None = None,
    force: bool = False,
    optimise: bool = False,
    draw: Path | None = None,
    trials: int = TRIALS,
    planner: Planner | None = None,
    progress: Progress | None = None,
) -> PlanOutcome:
    """Plan a task and check the plan. If there is no plan, the outcome explains why.

    If a time or memory limit is reached, the outcome contains the results so far.

    Args:
        source: a task, the path of a task file, or the name of a bundled task.
        settings: settings that override the task file.
        folder: folder for plan.json, the PDDL files and the task file; by default no files are written.
        force: whether to replace the files of another run.
        optimise: whether to optimise the hyperparameters, and to replan if no values satisfy all conditions.
        draw: file for a picture of the movements, whose suffix is ``.png``, ``.svg`` or ``.pdf``. If a plan was refused
            because a movement hits a body, the picture shows this movement.
        trials: maximum number of changed tasks to try if there is no plan, in the search for a change that makes the
            task solvable.
        planner: a running planner process; by default a new process is started.
        progress: called with the completed fraction of the work and the name of the current activity.

    Raises:
        InputError: the task file is wrong, the planner is unknown or not installed, or a file cannot be written.
        NotFinite: every rollout of a plan failed.
    """
    with ExitStack() as stack:
        # Start the planner process first, so that its start-up overlaps with the reading of the task file.
        process = planner or stack.enter_context(PlannerProcess())
        task, deadline = load_timed(source, settings, plans=True)
        target = None if folder is None else RunFolder.open(folder, force=force)
        if draw is not None:
            check_picture(draw, force=force)
        planning = partial(plan_task, planner=process, deadline=deadline, expectations=Expectations())
        if optimise:
            outcome = plan_and_refine(task, planning, progress, deadline=deadline)
        else:
            outcome = avoid_collisions(planning(task), planning, deadline)
        outcome = blame_factors(outcome, process, deadline)
    if outcome.plan is None:
        outcome = explain_outcome(outcome, trials, 1, deadline)
    if draw is not None:
        outcome = draw_plan(outcome, draw, deadline)
    if target is not None:
        save_plan(outcome, target)
        if draw is not None:
            draw_into(target, outcome, deadline)
    return outcome


def save_plan(outcome: PlanOutcome, folder: RunFolder) -> None:
    """Remove the files of an earlier run from a folder, and write the files of a plan into the folder.

    If there is no plan, PDDL is left out for goals with wildcards or with tokens of unknown classes. If a limit was
    reached, PDDL is always left out, because compiling a large task takes seconds.
    """
    # Read the task file before the folder is cleared, because the task file may be in this folder.
    text, named = portable(outcome.task)
    folder.clear()
    for name, content in {"task.yaml": text, **named}.items():
        folder.write_text(name, content)
    shown = document(outcome)
    folder.write_json("plan.json", shown)
    curve = convergence_picture(shown["refinement"]) if outcome.refinement else None
    if curve is not None:
        folder.write_bytes("convergence.png", curve)
    if outcome.status != "limit" and (outcome.plan is not None or outcome.task.definite):
        export(outcome.chosen or outcome.task, folder, outcome.plan)
