"""The verb ``run``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hybrid_tamp.cli.console import print_json, show
from hybrid_tamp.cli.options import (
    DomainOption,
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
    read_settings,
)

if TYPE_CHECKING:
    from hybrid_tamp.model.run_result import RunResult


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
    from hybrid_tamp.verbs.planner import start_planner

    with start_planner() as process:
        from hybrid_tamp.report.progress import progress_bar
        from hybrid_tamp.verbs.run import run as run_task

        settings = read_settings(
            **{"domain": domain, "planner": planner, "objective": objective, "seed": seed, "time_limit": time_limit},
            **{"memory_limit": memory_limit, "optimiser": optimiser, "evaluations": evaluations, "refine": refine},
        )
        with progress_bar() as tell:
            result = run_task(
                task, output, settings, backend=backend, video=video, force=force, planner=process, progress=tell
            )
    _show(result, as_json)
    if not as_json:
        typer.echo("\n".join([*([f"video: {video}"] if video else []), f"files: {output}"]))
    _judge(result, as_json)


def _judge(result: "RunResult", as_json: bool) -> None:
    """Say what was wrong, or that the goal was reached.

    Raises:
        Exit: the goal was not reached or the law was broken.
    """
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


def _show(result: "RunResult", as_json: bool) -> None:
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.refinement_tables import refinement_tables
    from hybrid_tamp.report.tables import plan_table, result_table

    shown = document(result)
    if as_json:
        print_json(shown)
        return
    plan = document(result.outcome)
    show(plan_table(plan, result.task.domain.resting))
    if plan["refinement"] is not None:
        show(refinement_tables(plan["refinement"], shown["performance"]))
    show(result_table(shown))
