"""Verbs that say what there is: domains, schema."""

from typing import Annotated

import typer

from hybrid_tamp.cli.options import Document, JsonOption
from hybrid_tamp.console import print_json, show


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


def schema(
    document: Annotated[Document, typer.Argument(help="which document")] = Document.task,
    reference: Annotated[bool, typer.Option("--reference", help="a reference page in Markdown instead")] = False,
) -> None:
    """Print the JSON Schema of task files, or of the documents that are printed and written."""
    if document is not Document.task:
        from hybrid_tamp.report.affordance_documents import affordance_schemas
        from hybrid_tamp.report.documents import json_schemas

        print_json({**json_schemas(), **affordance_schemas()}[f"{document.value}-1"])
        return
    from hybrid_tamp.taskfile.domains import available_domains, find_domain
    from hybrid_tamp.taskfile.schema import json_schema, reference_page

    found = [find_domain(name) for name in available_domains()]
    if reference:
        typer.echo(reference_page(found), nl=False)
    else:
        print_json(json_schema(found))
