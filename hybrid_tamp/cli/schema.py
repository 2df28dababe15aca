"""The verb that says what files look like: schema."""

from enum import Enum
from typing import Annotated

import typer

from hybrid_tamp.cli.console import print_json


class Document(str, Enum):
    """Documents whose JSON Schema can be printed."""

    task = "task"
    plan = "plan"
    result = "result"
    explain = "explain"
    affordances = "affordances"


def schema(
    document: Annotated[Document, typer.Argument(help="which document")] = Document.task,
    reference: Annotated[bool, typer.Option("--reference", help="a reference page in Markdown instead")] = False,
) -> None:
    """Print the JSON Schema of task files, or of the documents that are printed and written."""
    from hybrid_tamp.verbs.schema import find_schema, write_reference

    if reference and document is Document.task:
        typer.echo(write_reference(), nl=False)
    else:
        print_json(find_schema(document.value))
