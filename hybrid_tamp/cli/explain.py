"""The verb ``explain``."""

from typing import Annotated

import typer

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say

_STATUS = {"solved": 0, "unsolvable": 10, "unknown": 11, "limit": 20}


def explain(
    context: typer.Context,
    task: options.Task,
    as_json: options.Json = False,
    domain: options.Domain = None,
    planner: options.Planner = None,
    trials: Annotated[
        int, typer.Option("--trials", min=0, max=10**6, metavar="N", help="maximum number of changed tasks to try")
    ] = 20,
    most: Annotated[int, typer.Option("--most", min=1, help="maximum number of changes to find")] = 5,
    optimise: Annotated[
        bool, typer.Option("--optimise", help="also optimise the plan's hyperparameters, as 'plan --optimise' does")
    ] = False,
    time_limit: options.Time = None,
    memory_limit: options.Memory = None,
) -> None:
    """Explain why a task has no plan, and what would change this.

    The suggestions are single changes that make the task solvable. If the task has a plan, the output states why each
    token is in the plan.

    Example: hybrid-tamp explain roll_cylinder_off_axis
    """
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.progress import progress_bar
    from hybrid_tamp.report.question_tables import explanation_table
    from hybrid_tamp.verbs.explain import explain as explain_task
    from hybrid_tamp.verbs.loading import Settings

    settings = Settings(domain, planner, time_limit=time_limit, memory_limit=memory_limit, began=context.obj)
    with progress_bar("explaining") as tell:
        result = explain_task(task, settings, trials=trials, most=most, optimise=optimise, progress=tell)
    say(document(result), as_json, lambda: explanation_table(result))
    if result.explanation is not None and result.explanation.stopped is not None:
        typer.echo(f"{result.explanation.stopped}; only some of the possible changes were tried", err=True)
    if result.status != "solved":
        raise typer.Exit(_STATUS[result.status])
