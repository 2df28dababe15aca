"""The verb ``network``."""

from typing import Annotated

import typer

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say


def network(
    of: Annotated[str, typer.Argument(metavar="TASK|DOMAIN", help="a task or a domain (name, module or .py file)")],
    as_json: options.Json = False,
    domain: options.Domain = None,
) -> None:
    """Show the reassignment network of a domain or a task.

    Example: hybrid-tamp network rolling_tumbling
    """
    from hybrid_tamp.report.domain_documents import network_document
    from hybrid_tamp.report.tables import network_table
    from hybrid_tamp.verbs.network import find_network

    found = find_network(of, domain)
    say(network_document(found), as_json, lambda: network_table(found))
