"""The verb ``affordances``."""

from enum import Enum
from typing import Annotated

import typer

from hybrid_tamp.cli.console import print_json, show
from hybrid_tamp.cli.options import DomainOption, JsonOption, TaskArgument


class View(str, Enum):
    """Whose perspective on affordances is taken."""

    environment = "environment"
    agent = "agent"
    observer = "observer"
    team = "team"


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
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.question_tables import affordances_table
    from hybrid_tamp.verbs.affordances import affordances as find_affordances
    from hybrid_tamp.verbs.loading import Settings

    settings = Settings(domain=domain)
    result = find_affordances(task, settings, view=view.value, agent=agent, questions=what_if or [])
    if as_json:
        print_json(document(result))
    else:
        show(affordances_table(result))
