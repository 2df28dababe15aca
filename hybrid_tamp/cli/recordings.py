"""Verbs that take what runs left behind or what was shown: replay, report, learn."""

from pathlib import Path
from typing import Annotated

import typer

from hybrid_tamp.cli.console import say
from hybrid_tamp.cli.loading import finder
from hybrid_tamp.cli.options import DomainOption, ForceOption, JsonOption


def replay(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="the folder that a run left")],
    as_json: JsonOption = False,
    domain: DomainOption = None,
) -> None:
    """Run the recorded commands again and say whether the same happened, bit for bit."""
    from hybrid_tamp.verbs import pipeline

    report = pipeline.replay(directory, finder(domain))
    difference = report.first_difference
    document = {
        "schema": "hybrid-tamp/replay/1",
        "directory": str(directory),
        "identical": report.identical,
        "steps": report.steps,
        "first_difference": None if difference is None else dict(difference.__dict__),
        "refusal": report.refusal,
    }
    if report.identical:
        said = f"{directory}: {report.steps} steps run again, bit-identical"
    elif difference is not None:
        said = (
            f"{directory}: not identical; first at {difference.time:.4f} s, {difference.property} of "
            f"{difference.token} differs by {difference.size:.3g}"
        )
    else:
        said = f"{directory}: not identical; {report.refusal}"
    say(document, as_json, lambda: said)
    if not report.identical:
        raise typer.Exit(40)


def report(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="the folder that plan or run left")],
    as_json: JsonOption = False,
) -> None:
    """Write report.html again from the documents in the folder."""
    from hybrid_tamp.report.folder import RunFolder
    from hybrid_tamp.report.page import write_page

    file = str(write_page(RunFolder(directory)))
    say({"schema": "hybrid-tamp/report/1", "directory": str(directory), "file": file}, as_json, lambda: file)


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
    from hybrid_tamp.verbs.learn import learn as learnt
    from hybrid_tamp.verbs.learn import save_primitive

    primitive = learnt(block, demonstrations, domain=domain, token=token, weights=weights)
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
