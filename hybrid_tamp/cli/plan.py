"""The verb ``plan``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say, show
from hybrid_tamp.errors import InputError, Issue

if TYPE_CHECKING:
    from hybrid_tamp.model.outcome import PlanOutcome
    from hybrid_tamp.verbs.loading import Settings


def plan(
    context: typer.Context,
    task: options.Task,
    as_json: options.Json = False,
    domain: options.Domain = None,
    planner: options.Planner = None,
    objective: options.Objective = None,
    draw: Annotated[
        Path | None, typer.Option("--draw", metavar="FILE.png", help="picture of the movements (.png, .svg or .pdf)")
    ] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="folder for the files of the plan")] = None,
    force: options.Force = False,
    seed: options.Seed = None,
    time_limit: options.Time = None,
    memory_limit: options.Memory = None,
    optimise: Annotated[bool, typer.Option("--optimise", help="also optimise the plan's hyperparameters")] = False,
    optimiser: options.Optimiser = None,
    evaluations: options.Evaluations = None,
    refine: options.Refine = None,
    compare_planners: options.ComparePlanners = False,
) -> None:
    """Plan a task, or explain why there is no plan.

    Example: hybrid-tamp plan tumble_two_hands --optimise
    """
    if not optimise and (optimiser, evaluations, refine) != (None, None, None):
        raise InputError([Issue("", "--optimiser, --evaluations and --refine must be used together with --optimise")])
    from hybrid_tamp.verbs.planner import start_planner

    with start_planner() as process:
        from hybrid_tamp.report.progress import progress_bar
        from hybrid_tamp.verbs.loading import Settings
        from hybrid_tamp.verbs.plan import plan as plan_task

        limits = (time_limit, memory_limit)
        settings = Settings(domain, planner, objective, seed, *limits, optimiser, evaluations, refine, context.obj)
        if compare_planners:
            return _compare(task, settings, as_json)
        with progress_bar() as tell:
            outcome = plan_task(
                task, settings, folder=output, force=force, optimise=optimise, draw=draw, planner=process, progress=tell
            )
    _show(outcome, as_json, draw)
    _judge(outcome)


def _judge(outcome: "PlanOutcome") -> None:
    """If planning failed, exit, and print the error unless the explanation states it."""
    if outcome.error is not None:
        if outcome.explanation is None or outcome.explanation.stopped is not None:
            typer.echo(str(outcome.error), err=True)
        raise typer.Exit(outcome.error.exit_status)


def _compare(task: str, settings: "Settings", as_json: bool) -> None:
    from hybrid_tamp.report.listings import comparison_document, comparison_of_planners
    from hybrid_tamp.report.progress import progress_bar
    from hybrid_tamp.verbs.compare_planners import compare_planners

    with progress_bar() as tell:
        results = compare_planners(task, settings, tell)
    say(comparison_document(task, results), as_json, lambda: comparison_of_planners(task, results))


def _show(outcome: "PlanOutcome", as_json: bool, drawn: Path | None) -> None:
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.refinement_tables import refinement_tables
    from hybrid_tamp.report.tables import (
        clearance_text,
        explanation_text,
        network_text,
        plan_footer,
        plan_table,
        timeline,
    )

    shown = document(outcome)
    say(shown, as_json)
    if as_json:
        return
    if outcome.plan is None:
        show(explanation_text(shown["explanation"]), stderr=True)
    else:
        resting = outcome.task.domain.resting
        show(plan_table(shown, resting))
        show(timeline(outcome.plan, [token.name for token in outcome.task.assigned], resting))
        if outcome.refinement is not None:
            show(refinement_tables(shown["refinement"]))
        show(plan_footer(shown))
        show(clearance_text(shown["clearance"]))
    show(network_text(shown["network"]), stderr=outcome.plan is None)
    if drawn is not None:
        show(f"picture: {drawn}", stderr=outcome.plan is None)
