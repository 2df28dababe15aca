"""The verb that writes the page of a run again: report."""

from pathlib import Path
from typing import Annotated

import typer

from hybrid_tamp.cli.console import say
from hybrid_tamp.cli.options import DomainOption, JsonOption


def report(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="the folder that plan or run left")],
    as_json: JsonOption = False,
    domain: DomainOption = None,
) -> None:
    """Write report.html again from the documents in the folder."""
    from hybrid_tamp.verbs.loading import Settings
    from hybrid_tamp.verbs.report import write_report

    file = str(write_report(directory, Settings(domain=domain)))
    say({"schema": "hybrid-tamp/report/1", "directory": str(directory), "file": file}, as_json, lambda: file)
