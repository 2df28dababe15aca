"""Verbs that watch other agents: imitate."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hybrid_tamp.cli.console import print_json, show
from hybrid_tamp.cli.options import DomainOption, ForceOption, JsonOption, TaskArgument

if TYPE_CHECKING:
    from hybrid_tamp.questions.imitate.segmentation import Segmentation
    from hybrid_tamp.verbs.imitate import Imitation, Shown


def imitate(
    shown: Annotated[
        Path, typer.Argument(metavar="DIR|FILE", help="the folder that a run left, or a CSV file of tokens' poses")
    ],
    task: TaskArgument,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="folder for the files of the run")] = None,
    as_json: JsonOption = False,
    domain: DomainOption = None,
    actor: Annotated[
        str | None, typer.Option("--actor", metavar="TASK", help="whose tokens a FILE shows; those of TASK by default")
    ] = None,
    backend: Annotated[str, typer.Option("--backend", metavar="NAME", help="physics backend")] = "pybullet",
    force: ForceOption = False,
) -> None:
    """Do as another agent was seen to do, and say which blocks were seen."""
    from hybrid_tamp.report.folder import RunFolder
    from hybrid_tamp.report.progress import progress_bar
    from hybrid_tamp.verbs.imitate import imitate as imitated
    from hybrid_tamp.verbs.imitate import read_shown, segmented
    from hybrid_tamp.verbs.loading import Settings, domain_finder, load

    settings, find_domain = Settings(domain=domain), domain_finder(domain)
    loaded = load(task, settings)
    seen = read_shown(shown, loaded, find_domain, None if actor is None else load(actor, settings))
    with TemporaryDirectory() as temporary, progress_bar() as progress:
        folder = RunFolder.create(output or Path(temporary) / "run", force=force)
        progress(0.0, "segmenting")
        segmentation = segmented(seen)
        if not as_json:
            _show_segmentation(seen, segmentation)
        result = imitated(
            seen, segmentation, loaded, folder, backend=backend, progress=progress, find_domain=find_domain
        )
    _report(seen, segmentation, result, as_json)
    if output and not as_json:
        typer.echo(f"files: {output}")
    run = result.result
    if not run.success or run.law:
        typer.echo("The imitation did not reach the goal.", err=True)
        raise typer.Exit(40)
    if not as_json:
        typer.echo(f"The imitation reached the goal after {run.recording.duration:.2f} s of simulated time.")


def _show_segmentation(seen: "Shown", segmentation: "Segmentation") -> None:
    from hybrid_tamp.report.tables import timetable

    show(timetable(f"What {seen.source} shows", segmentation.plan))
    for movement in segmentation.unexplained:
        typer.echo(f"not explained: {movement}", err=True)


def _report(seen: "Shown", segmentation: "Segmentation", result: "Imitation", as_json: bool) -> None:
    if as_json:
        print_json(_document(seen, segmentation, result))
        return
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.tables import result_table

    roles = ", ".join(f"{name} as {token}" for token, name in result.roles.items())
    typer.echo(f"roles: {roles}")
    if result.primitives:
        typer.echo(f"learnt: {', '.join(result.primitives)}")
    show(result_table(document(result.result)))


def _document(seen: "Shown", segmentation: "Segmentation", result: "Imitation") -> dict[str, Any]:
    from hybrid_tamp.report.documents import document

    instances = sorted(segmentation.plan.instances, key=lambda i: (i.start, i.end, i.name))
    return {
        "schema": "hybrid-tamp/imitate/1",
        "shown": seen.source,
        "instances": [
            {
                "instance": i.name,
                "block": i.block,
                "start": i.start,
                "end": i.end,
                "slots": dict(i.slots),
                "targets": dict(i.targets),
            }
            for i in instances
        ],
        "unexplained": [
            {"token": each.token, "start": each.start, "end": each.end} for each in segmentation.unexplained
        ],
        "roles": dict(result.roles),
        "primitives": {name: {"rms": each.rms, "unit": each.unit} for name, each in result.primitives.items()},
        "result": document(result.result),
    }
