"""The verb ``pddl``."""

from pathlib import Path
from typing import Annotated

import typer

from hybrid_tamp.cli.console import say
from hybrid_tamp.cli.options import DomainOption, Encoding, ForceOption, JsonOption, TaskArgument


def pddl(
    task: TaskArgument,
    output: Annotated[Path, typer.Option("-o", "--output", help="folder for domain.pddl and problem.pddl")],
    as_json: JsonOption = False,
    domain: DomainOption = None,
    force: ForceOption = False,
    encoding: Annotated[
        Encoding, typer.Option("--encoding", help="slot by slot without time, or one durative action a block")
    ] = Encoding.classical,
    solve: Annotated[bool, typer.Option("--solve", help="plan the task, too, and write plan.pddl")] = False,
) -> None:
    """Write the task as PDDL that any planner reads."""
    from hybrid_tamp.verbs.loading import Settings, load
    from hybrid_tamp.verbs.pddl import pddl as write_pddl

    loaded = load(task, Settings(domain=domain))
    written = write_pddl(loaded, output, encoding=encoding.value, solve=solve, force=force)
    files = [str(path) for path in written]
    document = {"schema": "hybrid-tamp/pddl/1", "task": loaded.name, "encoding": encoding.value, "files": files}
    say(document, as_json, lambda: "\n".join(files))
