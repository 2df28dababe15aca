"""The command ``hybrid-tamp`` with its verbs and global options."""

import logging
import sys
import time
from importlib import metadata
from typing import Annotated

import typer

from hybrid_tamp.cli.affordances import affordances
from hybrid_tamp.cli.check import check
from hybrid_tamp.cli.check_domain import check_domain
from hybrid_tamp.cli.domains import domains
from hybrid_tamp.cli.explain import explain
from hybrid_tamp.cli.imitate import imitate
from hybrid_tamp.cli.learn import learn
from hybrid_tamp.cli.network import network
from hybrid_tamp.cli.new import new
from hybrid_tamp.cli.pddl import pddl
from hybrid_tamp.cli.plan import plan
from hybrid_tamp.cli.planners import planners
from hybrid_tamp.cli.probe import probe
from hybrid_tamp.cli.replay import replay
from hybrid_tamp.cli.report import report
from hybrid_tamp.cli.run import run
from hybrid_tamp.cli.scene import scene
from hybrid_tamp.cli.schema import schema
from hybrid_tamp.cli.tasks import tasks

app = typer.Typer(
    name="hybrid-tamp",
    help="Plan a manipulation task, export its PDDL, run it in physics, or find out why it has no plan.",
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"hybrid-tamp {metadata.version('hybrid-tamp')}")
        raise typer.Exit


@app.callback()
def _options(
    context: typer.Context,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="show the stages and their times on standard error")
    ] = False,
    version: Annotated[
        bool, typer.Option("--version", help="print the version", is_eager=True, callback=_version)
    ] = False,
) -> None:
    context.obj = time.monotonic()  # The time limit counts from here, before a verb imports its modules.
    level = logging.INFO if verbose else logging.WARNING
    # The elapsed time shows which stage takes long.
    form = "%(relativeCreated)7.0f ms  %(message)s" if verbose else "%(levelname)s %(name)s: %(message)s"
    logging.basicConfig(level=level, format=form, stream=sys.stderr)


_QUESTIONS = (learn, imitate, explain, affordances, probe)
_LISTS = (network, tasks, domains, planners)
for verb in (check, plan, pddl, run, replay, report, *_QUESTIONS, *_LISTS, schema, scene, new, check_domain):
    app.command()(verb)  # the help lists the verbs in this order
