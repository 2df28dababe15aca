"""The verb ``learn``."""

from pathlib import Path
from typing import Annotated

import typer

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say


def learn(
    block: Annotated[
        str, typer.Argument(metavar="BLOCK", help="a block, or an action whose modes share one kind of movement")
    ],
    demonstrations: Annotated[
        list[Path], typer.Argument(metavar="DEMO...", help="folders of runs, or CSV files of timed positions or poses")
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE.json", help="file to write")],
    as_json: options.Json = False,
    domain: options.Domain = None,
    token: Annotated[
        str | None, typer.Option("--token", metavar="NAME", help="use only the movements of this token")
    ] = None,
    weights: Annotated[int, typer.Option("--weights", min=1, max=1000, help="number of basis functions")] = 20,
    force: options.Force = False,
) -> None:
    """Learn the motor primitive of a block from runs.

    Example: hybrid-tamp learn REACHING:behind out -o reach.json
    """
    from hybrid_tamp.verbs.learn import learn as fit
    from hybrid_tamp.verbs.learn import save_primitive

    primitive = fit(block, demonstrations, domain=domain, token=token, weights=weights)
    save_primitive(primitive, output, force=force)
    document = {
        "schema": "hybrid-tamp/learn/1",
        "file": str(output),
        "block": block,
        "dimensions": primitive.dimensions,
        "weights": weights,
        "sources": primitive.sources,
        "rms": primitive.rms,
        "unit": primitive.unit,
    }
    error = f"rms error {primitive.rms:.2g} {primitive.unit} over {', '.join(primitive.sources)}"
    text = f"{output}: primitive of {block} with {weights} weights per dimension, {error}"
    say(document, as_json, lambda: text)
