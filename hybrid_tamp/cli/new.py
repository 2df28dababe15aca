"""The verb ``new``."""

from pathlib import Path
from typing import Annotated

import typer


def new(folder: Annotated[Path, typer.Argument(metavar="DIR", help="folder for the new domain")]) -> None:
    """Write a small working domain with a task and tests.

    Example: hybrid-tamp new my_domain
    """
    from hybrid_tamp.verbs.new import new as write_domain

    for path in write_domain(folder):
        typer.echo(f"wrote {path}")
    typer.echo(f"next: hybrid-tamp run {folder / 'task.yaml'} --output out")
