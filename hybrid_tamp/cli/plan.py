"""The verb ``plan``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hybrid_tamp.cli.console import explain, print_json, show, tell_network
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
from hybrid_tamp.errors import InputError, Issue

if TYPE_CHECKING:
    from hybrid_tamp.model.outcome import PlanOutcome


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
    from hybrid_tamp.verbs.planner import start_planner

    with start_planner() as process:
        from hybrid_tamp.report.progress import progress_bar
        from hybrid_tamp.verbs.plan import plan as plan_task

        settings = read_settings(
            **{"domain": domain, "planner": planner, "objective": objective, "seed": seed, "time_limit": time_limit},
            **{"memory_limit": memory_limit, "optimiser": optimiser, "evaluations": evaluations, "refine": refine},
        )
        with progress_bar(optimise) as tell:
            outcome = plan_task(
                task, settings, folder=output, force=force, optimise=optimise, planner=process, progress=tell
            )
    _show(outcome, as_json)
    if outcome.error is not None:
        raise typer.Exit(outcome.error.exit_status)


def _show(outcome: "PlanOutcome", as_json: bool) -> None:
    from hybrid_tamp.report.documents import document

    shown = document(outcome)
    if as_json:
        print_json(shown)
        return
    if outcome.plan is None:
        explain(shown["explanation"])
    else:
        from hybrid_tamp.report.refinement_tables import refinement_tables
        from hybrid_tamp.report.tables import plan_footer, plan_table, timeline

        resting = outcome.task.domain.resting
        show(plan_table(shown, resting))
        show(timeline(outcome.plan, [token.name for token in outcome.task.assigned], resting))
        if outcome.refinement is not None:
            show(refinement_tables(shown["refinement"]))
        typer.echo(plan_footer(shown))
    tell_network(shown)
