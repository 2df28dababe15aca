"""The verb ``schema``."""

from typing import Annotated, Literal

import typer

from hybrid_tamp.cli.console import say


def schema(
    document: Annotated[
        Literal["task", "plan", "result", "explain", "affordances"], typer.Argument(help="kind of document")
    ] = "task",
    reference: Annotated[
        bool, typer.Option("--reference", help="print the Markdown reference of task files instead")
    ] = False,
) -> None:
    """Print the JSON Schema of task files or of a document.

    Example: hybrid-tamp schema > task.schema.json
    """
    from hybrid_tamp.verbs.schema import find_schema, write_reference

    if reference and document == "task":
        typer.echo(write_reference(), nl=False)
    else:
        say(find_schema(document), as_json=True)
