"""The verb that shows which slot follows which: network."""

from typing import Annotated

import typer

from hybrid_tamp.cli.console import print_json, show
from hybrid_tamp.cli.options import DomainOption, JsonOption


def network(
    of: Annotated[str, typer.Argument(metavar="TASK|DOMAIN", help="a task, or a domain's name, module or .py file")],
    as_json: JsonOption = False,
    domain: DomainOption = None,
) -> None:
    """Print the reassignment network: which slot a token may go to next."""
    from hybrid_tamp.verbs.network import find_network

    found = find_network(of, domain)
    if as_json:
        from hybrid_tamp.report.domain_documents import network_document

        print_json(network_document(found))
    else:
        from hybrid_tamp.report.tables import network_table

        show(network_table(found))
