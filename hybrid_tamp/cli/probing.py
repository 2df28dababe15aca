"""The verb that finds out what a token never seen before is good for: probe."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hybrid_tamp.cli.console import print_json, show
from hybrid_tamp.cli.loading import finder, load
from hybrid_tamp.cli.options import DomainOption, ForceOption, JsonOption, SeedOption, TaskArgument

if TYPE_CHECKING:
    from hybrid_tamp.questions.probe.verdicts import ProbeReport


def probe(
    task: TaskArgument,
    token: Annotated[str, typer.Option("--token", metavar="NAME", help="the token never seen before")],
    classes: Annotated[
        list[str] | None, typer.Option("--class", metavar="CLASS", help="class to try; default: all it is unknown in")
    ] = None,
    as_json: JsonOption = False,
    write: Annotated[
        Path | None, typer.Option("--write", metavar="NEW.yaml", help="write a task in which the token is a member")
    ] = None,
    starts: Annotated[int, typer.Option("--seeds", min=1, max=1000, help="from how many starts a class is tried")] = 4,
    most_starts: Annotated[
        int, typer.Option("--most-seeds", min=1, max=1000, help="from how many at most, while the verdict is unsure")
    ] = 16,
    domain: DomainOption = None,
    force: ForceOption = False,
    seed: SeedOption = None,
    time_limit: Annotated[float | None, typer.Option("--time-limit", min=0.001, help="of the probe [s]")] = None,
) -> None:
    """Find out of which classes a token is a member: rank them by its shape, predict, and try in physics."""
    from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess

    with PlannerProcess() as process:
        loaded = load(task, domain)
        if seed is not None:
            loaded = loaded.replaced(seed=seed)
        from hybrid_tamp.report.progress import progress_bar
        from hybrid_tamp.verbs.probe import probe as find_out
        from hybrid_tamp.verbs.probe import probe_document, save_members

        with progress_bar() as tell:
            report = find_out(
                loaded,
                token,
                classes or (),
                starts=starts,
                most_starts=most_starts,
                seconds=time_limit,
                planner=process,
                tell=tell,
            )
    if as_json:
        print_json(probe_document(report))
    else:
        _show(report)
    if write is not None:
        joined = save_members(loaded, report, write, force=force, find_domain=finder(domain))
        typer.echo(f"{write}: {token} is a member of {', '.join(joined)}", err=as_json)


def _show(report: "ProbeReport") -> None:
    from rich.table import Table

    faces = f"{len(report.resting)} faces to rest on" if report.resting else "no face to rest on"
    typer.echo(f"{report.token} has {faces}.")
    table = Table("class", "likelihood", "as", "verdict", "trials", "95 % of", header_style="bold")
    for verdict in report.verdicts:
        low, high = verdict.interval
        table.add_row(
            verdict.object_class,
            f"{verdict.likelihood:.2f}",
            verdict.labelled or "",
            verdict.verdict,
            f"{verdict.successes} of {len(verdict.trials)}",
            f"{low:.2f} to {high:.2f}" if verdict.trials else "",
        )
    show(table)
    for verdict in report.verdicts:
        known = ", ".join(f"{name} {_written(value)}" for name, value in verdict.properties.items())
        if known:
            typer.echo(f"{verdict.object_class} with {known}")
        reasons = [verdict.obstacle, *(trial.why for trial in verdict.trials)]
        for reason in dict.fromkeys(filter(None, reasons)):
            typer.echo(f"{verdict.object_class}: {reason}")


def _written(value: object) -> str:
    return f"[{', '.join(f'{part:g}' for part in value)}]" if isinstance(value, tuple) else f"{value:g}"
