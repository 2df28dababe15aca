"""The verb ``imitate``."""

from contextlib import ExitStack
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say, show

if TYPE_CHECKING:
    from hybrid_tamp.model.imitation import ImitationResult, Segmentation


def imitate(
    context: typer.Context,
    shown: Annotated[
        Path, typer.Argument(metavar="DIR|FILE", help="the folder of a run, or a CSV file of token poses")
    ],
    task: options.Task,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="folder for the files of the run")] = None,
    as_json: options.Json = False,
    domain: options.Domain = None,
    actor: Annotated[
        str | None, typer.Option("--actor", metavar="TASK", help="the demonstrator's task, for a FILE; default: TASK")
    ] = None,
    backend: options.Backend = "pybullet",
    force: options.Force = False,
) -> None:
    """Segment a run into blocks, and let another agent imitate it.

    Example: hybrid-tamp imitate out roll_by_another_agent -o likewise
    """
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.progress import progress_bar
    from hybrid_tamp.verbs.imitate import imitate as imitate_agent
    from hybrid_tamp.verbs.loading import Settings

    with ExitStack() as stack:
        result = imitate_agent(
            shown,
            task,
            output or Path(stack.enter_context(TemporaryDirectory())) / "run",
            Settings(domain, began=context.obj),
            actor=actor,
            backend=backend,
            force=force,
            progress=stack.enter_context(progress_bar()),
            on_segmentation=partial(_show_segmentation, shown.name, as_json),
        )
    say(document(result), as_json)
    if not as_json:
        _show(result, output)
    if not result.success:
        typer.echo("The imitation did not reach the goal.", err=True)
        raise typer.Exit(40)


def _show_segmentation(name: str, as_json: bool, segmentation: "Segmentation") -> None:
    from hybrid_tamp.report.tables import timetable

    if not as_json:
        show(timetable(f"Blocks in {name}", segmentation.plan))
        for movement in segmentation.unexplained:
            typer.echo(movement.text, err=True)


def _show(result: "ImitationResult", output: Path | None) -> None:
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.tables import result_table

    typer.echo(f"roles: {', '.join(f'{name} in place of {token}' for token, name in result.roles.items())}")
    if result.primitives:
        typer.echo(f"learnt: {', '.join(result.primitives)}")
    show(result_table(document(result.run)))
    if output:
        typer.echo(f"files: {output}")
    if result.success:
        typer.echo(f"The imitation reached the goal after {result.run.recording.duration:.2f} s of simulated time.")
