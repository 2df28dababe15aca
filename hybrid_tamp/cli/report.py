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
    table: Annotated[
        Path | None,
        typer.Option("--csv", metavar="FILE", help="write the tokens' poses during the run as a CSV file"),
    ] = None,
    force: options.Force = False,
) -> None:
    """Write report.html again from the documents in a folder.

    Example: hybrid-tamp report out --csv poses.csv
    """
    from hybrid_tamp.verbs.loading import Settings
    from hybrid_tamp.verbs.report import write_report
    from hybrid_tamp.verbs.trajectories import save_trajectories

    page, written = str(write_report(directory, Settings(domain))), None
    if table is not None:
        save_trajectories(directory, table, force=force)
        written = str(table)
    document = {"schema": "hybrid-tamp/report/1", "directory": str(directory), "file": page, "csv": written}
    say(document, as_json, lambda: "\n".join(filter(None, (page, written))))
