"""The verb ``replay``."""

from pathlib import Path
from typing import Annotated

import typer

from hybrid_tamp.cli.console import say
from hybrid_tamp.cli.options import DomainOption, JsonOption


def replay(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="the folder that a run left")],
    as_json: JsonOption = False,
    domain: DomainOption = None,
) -> None:
    """Run the recorded commands again and say whether the same happened, bit for bit."""
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
        said = f"{directory}: {result.steps} steps run again, bit-identical"
    elif difference is not None:
        said = (
            f"{directory}: not identical; first at {difference.time:.4f} s, {difference.property} of "
            f"{difference.token} differs by {difference.size:.3g}"
        )
    else:
        said = f"{directory}: not identical; {result.refusal}"
    say(document, as_json, lambda: said)
    if not result.identical:
        raise typer.Exit(40)
