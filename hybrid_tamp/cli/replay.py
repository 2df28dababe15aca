"""The verb ``replay``."""

from pathlib import Path
from typing import Annotated

import typer

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say


def replay(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="the folder of a run")],
    as_json: options.Json = False,
    domain: options.Domain = None,
) -> None:
    """Repeat a recorded run, and compare the states bit for bit.

    Example: hybrid-tamp replay out
    """
    from hybrid_tamp.verbs.loading import domain_finder
    from hybrid_tamp.verbs.replay import replay as replay_run

    result = replay_run(directory, domain_finder(domain))
    difference = result.first_difference
    document = {
        "schema": "hybrid-tamp/replay/1",
        "directory": str(directory),
        "identical": result.identical,
        "steps": result.steps,
        "first_difference": None if difference is None else dict(difference.__dict__),
        "refusal": result.refusal,
    }
    if result.identical:
        text = f"the states of all {result.steps} replayed steps are bit-identical"
    elif difference is not None:
        where = f"the {difference.property} of {difference.token} first differs at {difference.time:.4f} s"
        text = f"not identical; {where} (by {difference.size:.3g})"
    else:
        text = f"not identical; {result.refusal}"
    say(document, as_json, lambda: f"{directory}: {text}")
    if not result.identical:
        raise typer.Exit(40)
