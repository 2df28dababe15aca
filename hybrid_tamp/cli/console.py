"""What the command line prints: text for people, one JSON document for programs."""

import json
import os
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import typer

from hybrid_tamp.cli.flags import with_flags
from hybrid_tamp.errors import HybridTampError, InputError, Issue

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

    from hybrid_tamp.report.documents import Json


def say(document: dict[str, Any], as_json: bool, sentence: Callable[[], str]) -> None:
    """Print the document for programs, or the sentence for people."""
    if as_json:
        print_json(document)
    else:
        typer.echo(sentence())


def print_json(document: dict[str, Any]) -> None:
    """Print one JSON document."""
    typer.echo(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False))


def show(renderable: "RenderableType") -> None:
    """Print a table or a text of rich."""
    _console().print(renderable)


def _console(stderr: bool = False) -> "Console":
    from rich.console import Console

    class Plain(Console):
        def on_broken_pipe(self) -> None:
            # Rich would end the process with status 1; whoever reads only the head of a table did nothing wrong.
            raise

    return Plain(stderr=stderr, highlight=False, markup=False)


def output_failed(error: OSError) -> int:
    """Return the exit status after standard output could not be written.

    Raises:
        OSError: it was not about standard output.
    """
    if error.filename is not None:
        raise error
    # Else the interpreter would try again as it ends.
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    if isinstance(error, BrokenPipeError):
        return 0  # the reader went away, e.g. `| head`
    typer.echo(f"standard output cannot be written: {error.strerror}", err=True)
    return 1


def explain(explanation: "Json") -> None:
    """Say why there is no plan, on standard error."""
    from hybrid_tamp.report.tables import explanation_text

    _console(stderr=True).print(explanation_text(explanation))


def tell_network(plan: "Json") -> None:
    """Say what part of the network was planned on: on standard output with a plan, else on standard error."""
    from hybrid_tamp.report.tables import network_text

    said = network_text(plan["network"])
    if said:
        typer.echo(said, err=plan["status"] != "solved")


def report_error(error: HybridTampError, as_json: bool) -> None:
    """Print an error: for people on standard error, for programs as one JSON document as well."""
    error = with_flags(error)
    typer.echo(str(error), err=True)
    if as_json:
        issues: tuple[Issue, ...] = error.issues if isinstance(error, InputError) else ()
        print_json(
            {
                "schema": "hybrid-tamp/error/1",
                "error": type(error).__name__,
                "status": error.exit_status,
                "message": str(error),
                "issues": [{**issue.__dict__, "message": str(issue)} for issue in issues],
            }
        )
