"""The verb ``imitate``."""

from contextlib import ExitStack
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from hybrid_tamp.cli.console import print_json, show
from hybrid_tamp.cli.options import DomainOption, ForceOption, JsonOption, TaskArgument

if TYPE_CHECKING:
    from hybrid_tamp.model.imitation import ImitationResult, Segmentation


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
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.progress import progress_bar
    from hybrid_tamp.verbs.imitate import imitate as imitate_agent
    from hybrid_tamp.verbs.loading import Settings

    with ExitStack() as stack:
        folder = output or Path(stack.enter_context(TemporaryDirectory())) / "run"
        progress = stack.enter_context(progress_bar())
        result = imitate_agent(
            shown,
            task,
            folder,
            Settings(domain=domain),
            actor=actor,
            backend=backend,
            force=force,
            progress=progress,
            on_segmentation=partial(_show_segmentation, shown.name, as_json),
        )
    if as_json:
        print_json(document(result))
    else:
        _show(result, output)
    if not result.success:
        typer.echo("The imitation did not reach the goal.", err=True)
        raise typer.Exit(40)


def _show_segmentation(name: str, as_json: bool, segmentation: "Segmentation") -> None:
    from hybrid_tamp.report.tables import timetable

    if not as_json:
        show(timetable(f"What {name} shows", segmentation.plan))
        for movement in segmentation.unexplained:
            typer.echo(f"not explained: {movement.text}", err=True)


def _show(result: "ImitationResult", output: Path | None) -> None:
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.tables import result_table

    roles = ", ".join(f"{name} as {token}" for token, name in result.roles.items())
    typer.echo(f"roles: {roles}")
    if result.primitives:
        typer.echo(f"learnt: {', '.join(result.primitives)}")
    show(result_table(document(result.run)))
    if output:
        typer.echo(f"files: {output}")
    if result.success:
        typer.echo(f"The imitation reached the goal after {result.run.recording.duration:.2f} s of simulated time.")
