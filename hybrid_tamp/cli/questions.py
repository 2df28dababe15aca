"""Verbs that answer questions about a task: explain, affordances."""

from enum import Enum
from typing import Annotated

import typer

from hybrid_tamp.cli.console import print_json, show
from hybrid_tamp.cli.loading import adjusted, load
from hybrid_tamp.cli.options import DomainOption, JsonOption, MemoryOption, PlannerOption, TaskArgument, TimeOption


class View(str, Enum):
    """Whose perspective on affordances is taken."""

    environment = "environment"
    agent = "agent"
    observer = "observer"
    team = "team"


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
    from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess

    with PlannerProcess() as process:
        loaded = adjusted(load(task, domain, plans=not planner), planner, None, None, time_limit, memory_limit)
        from hybrid_tamp.report.affordance_tables import explain_text
        from hybrid_tamp.verbs.inquiry import explain_task

        document, status = explain_task(loaded, process, seconds, most)
    if as_json:
        print_json(document.dump())
    else:
        show(explain_text(document))
    if status:
        raise typer.Exit(status)


def affordances(
    task: TaskArgument,
    view: Annotated[View, typer.Option("--view", help="whose perspective")] = View.environment,
    agent: Annotated[str | None, typer.Option("--agent", metavar="NAME", help="one agent of the task")] = None,
    what_if: Annotated[
        list[str] | None,
        typer.Option("--what-if", metavar="+CLASS|-TOKEN", help="what one token more or less would change"),
    ] = None,
    as_json: JsonOption = False,
    domain: DomainOption = None,
) -> None:
    """Say which object affords which block, to whom, and what one token more or less would change."""
    loaded = load(task, domain)
    from hybrid_tamp.report.affordance_tables import affordances_table
    from hybrid_tamp.verbs.inquiry import affordances as found

    document = found(loaded, view.value, agent, what_if or [])
    if as_json:
        print_json(document.dump())
    else:
        show(affordances_table(document))
