"""The verb ``check-domain``."""

from typing import Annotated

import typer

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say
from hybrid_tamp.errors import InputError


def check_domain(
    name: Annotated[
        str, typer.Argument(metavar="DOMAIN", help="a domain: a .py file, package.module:ATTRIBUTE, or a name")
    ],
    tasks: Annotated[
        list[str] | None,
        typer.Option("--task", metavar="TASK", help="task of the domain; default: the task files beside the .py file"),
    ] = None,
    as_json: options.Json = False,
    samples: Annotated[int, typer.Option("--samples", min=1, max=1000, help="minimum number of steps per block")] = 8,
    simulate: Annotated[bool, typer.Option("--physics/--no-physics", help="also run each block in PyBullet")] = True,
    seed: options.Seed = None,
) -> None:
    """Roll out the blocks of a domain, and report its mistakes.

    Example: hybrid-tamp check-domain joint_lifting --task lift_two_hands
    """
    from hybrid_tamp.report.domain_documents import mistakes_document
    from hybrid_tamp.report.progress import progress_bar
    from hybrid_tamp.report.tables import mistakes_table
    from hybrid_tamp.verbs.check_domain import check_domain_file

    with progress_bar("checking") as tell:
        report = check_domain_file(name, tasks or (), samples=samples, seed=seed or 0, simulate=simulate, tell=tell)
    say(mistakes_document(report), as_json, lambda: mistakes_table(report))
    if report.mistakes:
        raise typer.Exit(InputError.exit_status)
