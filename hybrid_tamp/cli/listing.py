"""Verbs that say what there is: domains, network, schema."""

from typing import TYPE_CHECKING, Annotated

import typer

from hybrid_tamp.cli.console import print_json, show
from hybrid_tamp.cli.loading import load
from hybrid_tamp.cli.options import Document, DomainOption, JsonOption

if TYPE_CHECKING:
    from hybrid_tamp.model.domain import Domain


def domains(as_json: JsonOption = False) -> None:
    """List the domains that are installed."""
    from hybrid_tamp.taskfile.domains import available_domains, find_domain

    found = [find_domain(name) for name in available_domains()]
    if as_json:
        print_json(
            {
                "schema": "hybrid-tamp/domains/1",
                "domains": [
                    {
                        "name": domain.name,
                        "description": domain.description,
                        "classes": [c.name for c in domain.classes],
                        "blocks": [b.name for b in domain.blocks],
                        "predicates": [p.name for p in domain.predicates],
                    }
                    for domain in found
                ],
            }
        )
        return
    from hybrid_tamp.report.tables import domains_table

    show(domains_table(found))


def network(
    of: Annotated[str, typer.Argument(metavar="TASK|DOMAIN", help="a task, or a domain's name, module or .py file")],
    as_json: JsonOption = False,
    domain: DomainOption = None,
) -> None:
    """Print the reassignment network: which slot a token may go to next."""
    found = _domain_of(of, domain)
    if not as_json:
        from hybrid_tamp.report.tables import network_table

        show(network_table(found))
        return
    print_json(
        {
            "schema": "hybrid-tamp/network/1",
            "domain": found.name,
            "blocks": [
                {"name": block.name, "slots": {slot.name: slot.object_class.name for slot in block.slots}}
                for block in found.blocks
            ],
            "edges": [[".".join(source), ".".join(target)] for source, target in found.network.edges],
        }
    )


def _domain_of(name: str, domain: str | None) -> "Domain":
    from hybrid_tamp.taskfile.domains import available_domains, find_domain

    if name in available_domains() or name.endswith(".py") or ":" in name:
        return find_domain(name)
    return load(name, domain).domain


def schema(
    document: Annotated[Document, typer.Argument(help="which document")] = Document.task,
    reference: Annotated[bool, typer.Option("--reference", help="a reference page in Markdown instead")] = False,
) -> None:
    """Print the JSON Schema of task files, or of the documents that are printed and written."""
    if document is not Document.task:
        from hybrid_tamp.report.documents import json_schemas

        print_json(json_schemas()[f"{document.value}-1"])
        return
    from hybrid_tamp.taskfile.domains import available_domains, find_domain
    from hybrid_tamp.taskfile.schema import json_schema, reference_page

    found = [find_domain(name) for name in available_domains()]
    if reference:
        typer.echo(reference_page(found), nl=False)
    else:
        print_json(json_schema(found))
