"""The verb ``probe``."""

from pathlib import Path
from typing import Annotated

import typer

from hybrid_tamp.cli.console import print_json, show
from hybrid_tamp.cli.options import DomainOption, ForceOption, JsonOption, SeedOption, TaskArgument


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
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.progress import progress_bar
    from hybrid_tamp.report.question_tables import membership_lines, membership_table, resting_text
    from hybrid_tamp.verbs.loading import Settings
    from hybrid_tamp.verbs.probe import probe as probe_token
    from hybrid_tamp.verbs.probe import save_members

    settings = Settings(domain=domain, seed=seed)
    with progress_bar() as tell:
        result = probe_token(
            task, token, classes or (), settings, starts=starts, most_starts=most_starts, seconds=time_limit, tell=tell
        )
    if as_json:
        print_json(document(result))
    else:
        typer.echo(resting_text(result))
        show(membership_table(result))
        for line in membership_lines(result):
            typer.echo(line)
    if write is not None:
        joined = save_members(task, result, write, settings, force=force)
        typer.echo(f"{write}: {token} is a member of {', '.join(joined)}", err=as_json)
