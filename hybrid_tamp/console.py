"""What the command line prints: text for people, one JSON document for programs."""

import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import typer

from hybrid_tamp.errors import HybridTampError, InputError, Issue

if TYPE_CHECKING:
    from rich.console import RenderableType

    from hybrid_tamp.report.documents import ExplanationEntry


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
    from rich.console import Console

    Console(highlight=False, markup=False).print(renderable)


def explain(explanation: "ExplanationEntry | None", as_json: bool) -> None:
    """Say why there is no plan, on standard error."""
    if explanation is None or as_json:
        return
    from rich.console import Console

    from hybrid_tamp.report.tables import explanation_text

    Console(stderr=True, highlight=False, markup=False).print(explanation_text(explanation))


def report_error(error: HybridTampError, as_json: bool) -> None:
    """Print an error: for people on standard error, for programs as one JSON document as well."""
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
