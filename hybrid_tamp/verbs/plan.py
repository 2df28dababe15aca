"""The verb ``plan``: a task goes in, a checked plan or the reason why there is none comes out."""

from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path

from hybrid_tamp.model.outcome import PlanOutcome
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.planning.replanning import Progress, plan_and_refine
from hybrid_tamp.questions.explain.explanation import explain_failure
from hybrid_tamp.report.convergence import convergence_picture
from hybrid_tamp.report.documents import document
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.strategies.search import Planner
from hybrid_tamp.taskfile.copying import portable
from hybrid_tamp.verbs.loading import Settings, load
from hybrid_tamp.verbs.pddl import export

SECONDS = 4.0
"""How long a single change is searched for with which there would be a plan [s]."""


def plan(
    source: Task | Path | str,
    settings: Settings = Settings(),  # noqa: B008
    *,
    folder: RunFolder | Path | str | None = None,
    force: bool = False,
    optimise: bool = False,
    seconds: float = SECONDS,
    planner: Planner | None = None,
    progress: Progress | None = None,
) -> PlanOutcome:
    """Plan a task; the plan is checked, and if there is none, the outcome explains why.

    Args:
        source: a task, the path of a task file, or the name of a bundled task.
        settings: what replaces what the file says.
        folder: where plan.json, PDDL and the task file go, if anywhere.
        force: whether they may replace another run's.
        optimise: whether to optimise the hyperparameters, too, and replan if none satisfy the plan.
        seconds: how long a single change is searched for with which there would be a plan, if there is none [s].
        planner: a running planner process; by default one is started for this call.
        progress: told how far the optimisation is.

    Raises:
        InputError: the task file is wrong, the engine is unknown or not installed, or the folder cannot be used.
        NotFinite: every rollout of a plan failed.
    """
    with ExitStack() as stack:
        # The planner's process starts up while the task file is read.
        process = planner or stack.enter_context(PlannerProcess())
        task = load(source, settings, plans=True)
        target = None if folder is None else RunFolder.open(folder, force=force)
        if optimise:
            outcome = plan_and_refine(task, partial(plan_task, planner=process), progress)
        else:
            outcome = plan_task(task, process)
    if outcome.plan is None:
        outcome = replace(outcome, explanation=explain_failure(outcome, seconds))
    if target is not None:
        save_plan(outcome, target)
    return outcome


def save_plan(outcome: PlanOutcome, folder: RunFolder) -> None:
    """Write a plan's document, convergence curve and PDDL, the task file and what it names, in place of another run's.

    A goal with a choice of which none was made has no PDDL, nor has one about a token of which too little is known.
    """
    # The task may be another run's, in this very folder.
    text, named = portable(outcome.task)
    folder.clear()
    for name, content in {"task.yaml": text, **named}.items():
        folder.write_text(name, content)
    shown = document(outcome)
    folder.write_json("plan.json", shown)
    curve = convergence_picture(shown["refinement"]) if outcome.refinement else None
    if curve is not None:
        folder.write_bytes("convergence.png", curve)
    if outcome.plan is not None or outcome.task.definite:
        export(outcome.chosen or outcome.task, folder, outcome.plan)
