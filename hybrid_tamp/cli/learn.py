"""The verb that learns a motor primitive: learn."""

from pathlib import Path
from typing import Annotated

import typer

from hybrid_tamp.cli.console import say
from hybrid_tamp.cli.options import DomainOption, ForceOption, JsonOption


def learn(
    block: Annotated[str, typer.Argument(metavar="BLOCK", help="a block, or an action whose modes all move alike")],
    demonstrations: Annotated[
        list[Path], typer.Argument(metavar="DEMO...", help="CSV files of time and position or pose, or folders of runs")
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE.json", help="the primitive's file")],
    as_json: JsonOption = False,
    domain: DomainOption = None,
    token: Annotated[str | None, typer.Option("--token", metavar="NAME", help="which token to watch in a run")] = None,
    weights: Annotated[int, typer.Option("--weights", min=1, max=1000, help="number of basis functions")] = 20,
    force: ForceOption = False,
) -> None:
    """Learn a block's motor primitive from what was shown."""
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

    def sentence() -> str:
        sources = ", ".join(primitive.sources)
        error = f"{primitive.rms:.2g} {primitive.unit} rms from what was shown"
        return f"{output}: primitive of {block} with {weights} weights a dimension, {error} ({sources})"

    say(document, as_json, sentence)
