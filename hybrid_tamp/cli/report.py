"""The verb ``report``."""

from pathlib import Path
from typing import Annotated

import typer

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say


def report(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="folder written by 'plan' or 'run'")],
    as_json: options.Json = False,
    domain: options.Domain = None,
) -> None:
    """Write report.html again from the documents in a folder.

    Example: hybrid-tamp report out
    """
    from hybrid_tamp.verbs.loading import Settings
    from hybrid_tamp.verbs.report import write_report

    file = str(write_report(directory, Settings(domain)))
    say({"schema": "hybrid-tamp/report/1", "directory": str(directory), "file": file}, as_json, lambda: file)
