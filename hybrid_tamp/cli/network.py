"""The verb ``network``."""

from pathlib import Path
from typing import Annotated

import typer

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say
from hybrid_tamp.errors import InputError, Issue


def network(
    context: typer.Context,
    of: Annotated[str, typer.Argument(metavar="TASK|DOMAIN", help="a task or a domain (name, module or .py file)")],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FILE", help="drawing to write: .svg, .png, .dot (Graphviz) or .mmd (Mermaid)"
        ),
    ] = None,
    reduced: Annotated[bool, typer.Option("--reduced", help="only the blocks that the task needs")] = False,
    plan: Annotated[bool, typer.Option("--plan", help="plan the task and mark the paths of its tokens")] = False,
    as_json: options.Json = False,
    domain: options.Domain = None,
    planner: options.Planner = None,
    force: options.Force = False,
) -> None:
    """Show or draw the network of a domain or a task.

    The table shows the slots that a token may enter after each slot.

    Example: hybrid-tamp network rolling_tumbling -o network.svg
    """
    if output is None and (plan or force):
        raise InputError([Issue("", "--plan and --force must be used together with --output")])
    from hybrid_tamp.report.domain_documents import network_document
    from hybrid_tamp.report.progress import progress_bar
    from hybrid_tamp.report.tables import network_table
    from hybrid_tamp.verbs.loading import Settings
    from hybrid_tamp.verbs.network import network as find_network

    settings = Settings(domain, planner, began=context.obj)
    with progress_bar("reading" if output is None else "planning and drawing" if plan else "drawing"):
        found = find_network(of, settings, file=output, reduced=reduced, plan=plan, force=force)
    document = network_document(found) | ({} if output is None else {"file": str(output)})
    say(document, as_json, lambda: network_table(found) if output is None else f"drawing: {output}")
