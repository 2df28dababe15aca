"""The verb ``affordances``."""

from typing import Annotated, Literal

import typer

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say


def affordances(
    task: options.Task,
    view: Annotated[
        Literal["environment", "agent", "observer", "team"], typer.Option("--view", help="perspective to show")
    ] = "environment",
    agent: Annotated[str | None, typer.Option("--agent", metavar="NAME", help="show only this agent")] = None,
    what_if: Annotated[
        list[str] | None,
        typer.Option("--what-if", metavar="+CLASS|-TOKEN", help="show the effect of adding or removing a token"),
    ] = None,
    as_json: options.Json = False,
    domain: options.Domain = None,
) -> None:
    """Show which objects afford which blocks to which agents.

    Example: hybrid-tamp affordances tumble_two_robots --view team
    """
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.question_tables import affordances_table
    from hybrid_tamp.verbs.affordances import affordances as find_affordances
    from hybrid_tamp.verbs.loading import Settings

    result = find_affordances(task, Settings(domain), view=view, agent=agent, questions=what_if or [])
    say(document(result), as_json, lambda: affordances_table(result))
