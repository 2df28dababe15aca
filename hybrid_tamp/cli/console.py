"""Print results and errors as text for people or as one JSON document for programs."""

import json
import os
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import typer

from hybrid_tamp.errors import HybridTampError, InputError, Issue, LimitReached, NoPlan

if TYPE_CHECKING:
    from rich.console import RenderableType

_FLAGS = {
    "agent": "--agent",
    "backend": "--backend",
    "block": "BLOCK",
    "classes": "--class",
    "questions": "--what-if",
    "token": "--token",
    "view": "--view",
}
"""Maps each parameter of the verbs' functions to its command-line flag or argument."""


def say(document: dict[str, Any], as_json: bool, *texts: "Callable[[], RenderableType]") -> None:
    """Print the document as JSON if `as_json` is true, else print the text or table that each function returns."""
    if as_json:
        typer.echo(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False))
        return
    for text in texts:
        show(text())


def show(renderable: "RenderableType", *, stderr: bool = False) -> None:
    """Print a string unchanged, or fit a rich table or text to the terminal. Print nothing for an empty string."""
    if isinstance(renderable, str):
        if renderable:
            typer.echo(renderable, err=stderr)
        return
    from rich.console import Console

    class Plain(Console):
        def on_broken_pipe(self) -> None:
            # Rich would exit with status 1, but a pipe that its reader closes (e.g. `| head`) is no error.
            raise

    Plain(stderr=stderr, highlight=False, markup=False).print(renderable)


def output_failed(error: OSError) -> int:
    """Return the exit status for a failure to write to standard output.

    Raises:
        OSError: the error concerns a file and not standard output.
    """
    if error.filename is not None:
        raise error
    # Redirect standard output, because Python writes to standard output again at exit.
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    if isinstance(error, BrokenPipeError):
        return 0  # the reader closed the pipe, e.g. `| head`
    typer.echo(f"cannot write to standard output: {error.strerror}", err=True)
    return 1


def report_error(error: HybridTampError, as_json: bool) -> None:
    """Print an error to standard error. If `as_json` is true, also print a JSON document to standard output."""
    error = _with_flags(error)
    typer.echo(str(error), err=True)
    issues: tuple[Issue, ...] = error.issues if isinstance(error, InputError) else ()
    document = {
        "schema": "hybrid-tamp/error/1",
        "error": type(error).__name__,
        "status": error.exit_status,
        "message": str(error),
        "issues": [{**issue.__dict__, "message": str(issue)} for issue in issues],
    }
    say(document, as_json)


def _with_flags(error: HybridTampError) -> HybridTampError:
    """Return the error with command-line flags in place of the names of function arguments."""
    if isinstance(error, LimitReached):
        return LimitReached(str(error).replace("time_limit", "--time-limit"), limit=error.limit)
    if isinstance(error, NoPlan) and error.probes:
        from hybrid_tamp.report.sources import describe_probe

        return error.extended(*(f"  {describe_probe(source, token)}" for source, token in error.probes))
    if not isinstance(error, InputError):
        return error
    issues = [
        replace(
            issue,
            where=_FLAGS.get(issue.where, issue.where),
            remedy=issue.remedy.replace("force=True", "--force").replace("classes=[...]", "--class"),
        )
        for issue in error.issues
    ]
    return type(error)(issues)
