"""Verbs that take a task: check, plan, pddl, run."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hybrid_tamp.cli.console import explain, print_json, say, show, tell_network
from hybrid_tamp.cli.loading import adjusted, load, with_midlevel
from hybrid_tamp.cli.options import (
    DomainOption,
    Encoding,
    EvaluationsOption,
    ForceOption,
    JsonOption,
    MemoryOption,
    ObjectiveOption,
    OptimiserOption,
    PlannerOption,
    RefineOption,
    SeedOption,
    TaskArgument,
    TimeOption,
)
from hybrid_tamp.errors import InputError, Issue

if TYPE_CHECKING:
    from hybrid_tamp.planning.plan import PlanOutcome


def check(task: TaskArgument, as_json: JsonOption = False, domain: DomainOption = None) -> None:
    """Check a task file: every fault at once, each with its place and what would be right."""
    loaded = load(task, domain, plans=True)
    summary = {
        "schema": "hybrid-tamp/check/1",
        "task": loaded.name,
        "domain": loaded.domain.name,
        "tokens": len(loaded.tokens),
        "goal": [str(atom) for atom in loaded.goal],
        "status": "ok",
    }
    say(summary, as_json, lambda: f"{loaded.source}: ok, {len(loaded.tokens)} tokens of {loaded.domain.name}")


def plan(
    task: TaskArgument,
    as_json: JsonOption = False,
    domain: DomainOption = None,
    planner: PlannerOption = None,
    objective: ObjectiveOption = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="folder for plan.json and PDDL")] = None,
    force: ForceOption = False,
    seed: SeedOption = None,
    time_limit: TimeOption = None,
    memory_limit: MemoryOption = None,
    optimise: Annotated[bool, typer.Option("--optimise", help="optimise the plan's hyperparameters, too")] = False,
    optimiser: OptimiserOption = None,
    evaluations: EvaluationsOption = None,
    refine: RefineOption = None,
) -> None:
    """Plan a task; show the checked plan, or why there is none."""
    if not optimise and (optimiser, evaluations, refine) != (None, None, None):
        wanted = "--optimiser, --evaluations and --refine say how to optimise: they go with --optimise"
        raise InputError([Issue("", wanted)])
    from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess

    # The planner's process warms up while the task file is read.
    with PlannerProcess() as process:
        loaded = adjusted(load(task, domain, plans=not planner), planner, objective, seed, time_limit, memory_limit)
        loaded = with_midlevel(loaded, optimiser, evaluations, refine)
        from hybrid_tamp.report.folder import RunFolder
        from hybrid_tamp.report.progress import progress_bar
        from hybrid_tamp.verbs import pipeline

        folder = RunFolder.create(output, force=force) if output else None
        if optimise:
            with progress_bar() as progress:
                outcome = pipeline.refine(loaded, process, progress).outcome
        else:
            outcome = pipeline.plan(loaded, process)
    if folder:
        pipeline.save_plan(outcome, folder)
    if as_json:
        print_json(outcome.document.dump())
    elif outcome.plan is not None:
        _show_plan(outcome)
    if outcome.error is not None:
        explain(outcome.document.explanation, as_json)
    if not as_json:
        tell_network(outcome.document)
    if outcome.error is not None:
        raise typer.Exit(outcome.error.exit_status)


def _show_plan(outcome: "PlanOutcome") -> None:
    from hybrid_tamp.report.refinement_tables import refinement_tables
    from hybrid_tamp.report.tables import plan_footer, plan_table, timeline

    show(plan_table(outcome.document))
    show(timeline(outcome.required(), [token.name for token in outcome.task.assigned]))
    if outcome.document.refinement is not None:
        show(refinement_tables(outcome.document.refinement))
    typer.echo(plan_footer(outcome.document))


def pddl(
    task: TaskArgument,
    output: Annotated[Path, typer.Option("-o", "--output", help="folder for domain.pddl and problem.pddl")],
    as_json: JsonOption = False,
    domain: DomainOption = None,
    force: ForceOption = False,
    encoding: Annotated[
        Encoding, typer.Option("--encoding", help="slot by slot without time, or one durative action a block")
    ] = Encoding.classical,
    solve: Annotated[bool, typer.Option("--solve", help="plan the task, too, and write plan.pddl")] = False,
) -> None:
    """Write the task as PDDL that any planner reads."""
    loaded = load(task, domain)
    from hybrid_tamp.report.folder import RunFolder
    from hybrid_tamp.verbs import pipeline

    folder = RunFolder.create(output, force=force)
    plan = pipeline.plan(loaded).required() if solve else None
    files = [str(path) for path in pipeline.export(loaded, folder, plan, encoding.value)]
    document = {"schema": "hybrid-tamp/pddl/1", "task": loaded.name, "encoding": encoding.value, "files": files}
    say(document, as_json, lambda: "\n".join(files))


def run(
    task: TaskArgument,
    output: Annotated[Path, typer.Option("-o", "--output", help="folder for the files of the run")],
    as_json: JsonOption = False,
    domain: DomainOption = None,
    planner: PlannerOption = None,
    objective: ObjectiveOption = None,
    backend: Annotated[str, typer.Option("--backend", metavar="NAME", help="physics backend")] = "pybullet",
    video: Annotated[Path | None, typer.Option("--video", metavar="FILE.mp4", help="draw a video")] = None,
    force: ForceOption = False,
    seed: SeedOption = None,
    time_limit: TimeOption = None,
    memory_limit: MemoryOption = None,
    optimiser: OptimiserOption = None,
    evaluations: EvaluationsOption = None,
    refine: RefineOption = None,
) -> None:
    """Plan a task, optimise its hyperparameters and carry the plan out in physics; record it and judge it."""
    from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess

    with PlannerProcess() as process:
        loaded = adjusted(load(task, domain, plans=not planner), planner, objective, seed, time_limit, memory_limit)
        loaded = with_midlevel(loaded, optimiser, evaluations, refine)
        from hybrid_tamp.report.folder import RunFolder
        from hybrid_tamp.report.progress import progress_bar
        from hybrid_tamp.verbs import pipeline

        folder = RunFolder.create(output, force=force)
        with progress_bar() as progress:
            outcome = pipeline.run(loaded, folder, planner=process, backend=backend, video=video, progress=progress)
    from hybrid_tamp.report.documents import document as document_of

    result, document = outcome.document, document_of(outcome.document)
    if as_json:
        print_json(document)
    else:
        from hybrid_tamp.report.refinement import PerformanceEntry
        from hybrid_tamp.report.refinement_tables import refinement_tables
        from hybrid_tamp.report.tables import plan_table, result_table

        measures = [PerformanceEntry(**each) for each in document["performance"]]

        show(plan_table(outcome.plan.document))
        if outcome.plan.document.refinement is not None:
            show(refinement_tables(outcome.plan.document.refinement, measures))
        show(result_table(document))
        if video:
            typer.echo(f"video: {video}")
        typer.echo(f"files: {output}")
    failure = result.recording.failure
    if failure is not None:
        typer.echo(f"step {failure.step}, {failure.instance}: {failure.reason}", err=True)
    for breach in result.law:
        typer.echo(f"the recording breaks {breach}", err=True)
    if not result.success or result.law:
        typer.echo("The plan was run and the goal was not reached.", err=True)
        raise typer.Exit(40)
    if not as_json:
        typer.echo(f"The goal was reached after {result.recording.duration:.2f} s of simulated time.")
