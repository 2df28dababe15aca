"""The verb ``probe``."""

from pathlib import Path
from typing import Annotated

import typer

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say


def probe(
    context: typer.Context,
    task: options.Task,
    token: Annotated[str, typer.Option("--token", metavar="NAME", help="token to probe")],
    classes: Annotated[
        list[str] | None, typer.Option("--class", metavar="CLASS", help="class to test; default: every unknown class")
    ] = None,
    as_json: options.Json = False,
    write: Annotated[
        Path | None, typer.Option("--write", metavar="NEW.yaml", help="write a task file with the confirmed classes")
    ] = None,
    starts: Annotated[int, typer.Option("--seeds", min=1, max=1000, help="initial number of trials per class")] = 4,
    most_starts: Annotated[
        int, typer.Option("--most-seeds", min=1, max=1000, help="maximum number of trials per class")
    ] = 16,
    domain: options.Domain = None,
    force: options.Force = False,
    seed: options.Seed = None,
    time_limit: options.Time = None,
) -> None:
    """Predict a token's classes from its shape, and test them.

    Example: hybrid-tamp probe tumble_unknown_box --token P5 --write known.yaml
    """
    from hybrid_tamp.report.documents import document
    from hybrid_tamp.report.progress import progress_bar
    from hybrid_tamp.report.question_tables import membership_lines, membership_table, resting_text
    from hybrid_tamp.verbs.loading import Settings
    from hybrid_tamp.verbs.probe import probe as probe_token
    from hybrid_tamp.verbs.probe import save_members

    settings = Settings(domain, seed=seed, time_limit=time_limit, began=context.obj)
    with progress_bar() as tell:
        result = probe_token(task, token, classes or (), settings, starts=starts, most_starts=most_starts, tell=tell)
    lines = "\n".join(membership_lines(result))
    say(document(result), as_json, lambda: resting_text(result), lambda: membership_table(result), lambda: lines)
    if write is not None:
        joined = save_members(task, result, write, settings, force=force)
        typer.echo(f"{write}: {token} is a member of {', '.join(joined)}", err=as_json)
