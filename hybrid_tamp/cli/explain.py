"""The verb ``explain``."""

from typing import Annotated

import typer

from hybrid_tamp.cli.console import print_json, show
from hybrid_tamp.cli.options import DomainOption, JsonOption, MemoryOption, PlannerOption, TaskArgument, TimeOption

_STATUS = {"solved": 0, "unsolvable": 10, "unknown": 11, "limit": 20}


def explain(
    task: TaskArgument,
    as_json: JsonOption = False,
    domain: DomainOption = None,
    planner: PlannerOption = None,
    seconds: Annotated[float, typer.Option("--seconds", min=0, help="how long to look for single changes [s]")] = 20.0,
    most: Annotated[int, typer.Option("--most", min=1, help="how many single changes are enough")] = 5,
    time_limit: TimeOption = None,
    memory_limit: MemoryOption = None,
) -> None:
    """Say why a task has no plan and which single change would give it one; or why each token is in its plan."""
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.question_tables import explanation_table
    from hybrid_tamp.verbs.explain import explain as explain_task
    from hybrid_tamp.verbs.loading import Settings

    settings = Settings(domain=domain, planner=planner, time_limit=time_limit, memory_limit=memory_limit)
    result = explain_task(task, settings, seconds=seconds, most=most)
    if as_json:
        print_json(document(result))
    else:
        show(explanation_table(result))
    if result.status != "solved":
        raise typer.Exit(_STATUS[result.status])
