"""The verb ``run``."""

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say
from hybrid_tamp.errors import NoPlan

if TYPE_CHECKING:
    from hybrid_tamp.model.run_result import RunResult

_PAGE = "report.html"

Video = Annotated[Path | None, typer.Option("--video", metavar="FILE.mp4", help="video to write")]
Gif = Annotated[Path | None, typer.Option("--gif", metavar="FILE.gif", help="animated GIF of at most 3 MB to write")]
Size = Annotated[
    str, typer.Option("--size", metavar="WIDTHxHEIGHT", help="size of the step pictures and the video [pixels]")
]
Compare = Annotated[
    bool, typer.Option("--compare", help="also run the plan with default hyperparameters, and compare the values")
]


def run(
    context: typer.Context,
    task: options.Task,
    output: Annotated[Path, typer.Option("-o", "--output", help="folder for the files of the run")],
    as_json: options.Json = False,
    domain: options.Domain = None,
    planner: options.Planner = None,
    objective: options.Objective = None,
    backend: options.Backend = "pybullet",
    video: Video = None,
    gif: Gif = None,
    size: Size = "1280x720",
    force: options.Force = False,
    compare: Compare = False,
    seed: options.Seed = None,
    time_limit: options.Time = None,
    memory_limit: options.Memory = None,
    optimiser: options.Optimiser = None,
    evaluations: options.Evaluations = None,
    refine: options.Refine = None,
) -> None:
    """Plan a task, optimise the plan, and run the plan in physics.

    Example: hybrid-tamp run roll_cylinder -o out --video out/video.mp4
    """
    from hybrid_tamp.verbs.planner import start_planner

    with start_planner() as process:
        from hybrid_tamp.report.frame_size import parse_size
        from hybrid_tamp.report.progress import progress_bar
        from hybrid_tamp.verbs.loading import Settings
        from hybrid_tamp.verbs.run import run as run_task

        limits = (time_limit, memory_limit)
        settings = Settings(domain, planner, objective, seed, *limits, optimiser, evaluations, refine, context.obj)
        run_here = partial(run_task, task, output, settings, backend=backend, planner=process)
        run_and_draw = partial(run_here, video=video, gif=gif, size=parse_size(size))
        with progress_bar() as tell, _pointing_at(output / _PAGE):
            result = run_and_draw(force=force, compare=compare, progress=tell)
    _show(result, as_json, {"page": output / _PAGE, "video": video, "GIF": gif})
    _judge(result, as_json)
    if not as_json:
        typer.echo(f"next: hybrid-tamp explain {task}\n      hybrid-tamp replay {output}")
        typer.echo(f"total time with pictures: {time.monotonic() - context.obj:.1f} s")


@contextmanager
def _pointing_at(page: Path) -> Iterator[None]:
    """If there is no plan, add the path of the page with the reasons to the message."""
    try:
        yield
    except NoPlan as error:
        raise error.extended(f"The page {page} shows the reasons.") from error


def _judge(result: "RunResult", as_json: bool) -> None:
    """Print that the goal was reached. Otherwise, print every failure, violation of the law and collision, and exit."""
    failure = result.recording.failure
    if failure is not None:
        typer.echo(f"step {failure.step}, {failure.instance}: {failure.reason}", err=True)
    for breach in result.law:
        typer.echo(f"the recording breaks {breach.text}", err=True)
    for collision in result.collisions:
        typer.echo(collision.text, err=True)
    for metric in result.out_of_bounds:
        typer.echo(metric.text, err=True)
    if not result.success or result.law or result.collisions:
        missed = "the goal was not reached" if not result.recording.success else "the run does not count as a success"
        typer.echo(f"The plan was executed but {missed}.", err=True)
        raise typer.Exit(40)
    if not as_json:
        typer.echo(f"The goal was reached after {result.recording.duration:.2f} s of simulated time.")


def _show(result: "RunResult", as_json: bool, written: Mapping[str, Path | None]) -> None:
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.refinement_tables import comparison_table, refinement_tables
    from hybrid_tamp.report.tables import clearance_text, plan_table, result_table

    shown, plan = document(result), document(result.outcome)
    say(
        shown,
        as_json,
        lambda: plan_table(plan, result.task.domain.resting),
        lambda: refinement_tables(plan["refinement"], shown["performance"]) if plan["refinement"] else "",
        lambda: result_table(shown),
        lambda: clearance_text(shown["clearance"]),
        lambda: comparison_table(shown["comparison"]) if shown["comparison"] else "",
        lambda: "\n".join(f"{kind}: {path}" for kind, path in written.items() if path),
    )
