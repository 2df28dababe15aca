"""The verb ``pddl``."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say


def pddl(
    task: options.Task,
    output: Annotated[Path, typer.Option("-o", "--output", help="folder for domain.pddl and problem.pddl")],
    as_json: options.Json = False,
    domain: options.Domain = None,
    force: options.Force = False,
    encoding: Annotated[
        Literal["classical", "temporal"],
        typer.Option("--encoding", help="classical: one action per slot; temporal: one durative action per block"),
    ] = "classical",
    solve: Annotated[bool, typer.Option("--solve", help="also plan the task and write plan.pddl")] = False,
) -> None:
    """Write a task as PDDL files for other planners.

    Example: hybrid-tamp pddl roll_cylinder -o pddl
    """
    from hybrid_tamp.verbs.loading import Settings, load
    from hybrid_tamp.verbs.pddl import pddl as write_pddl

    loaded = load(task, Settings(domain))
    files = [str(path) for path in write_pddl(loaded, output, encoding=encoding, solve=solve, force=force)]
    document = {"schema": "hybrid-tamp/pddl/1", "task": loaded.name, "encoding": encoding, "files": files}
    say(document, as_json, lambda: "\n".join(files))
