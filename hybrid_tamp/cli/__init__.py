"""The command line, which parses arguments, calls a verb, prints the result and returns an exit status.

Each verb is a command, e.g. ``plan`` or ``run``, and has its own module. The module `app` registers all verbs. Slow
imports are inside the functions of the verbs.
"""

import sys
from typing import cast

import typer

from hybrid_tamp.cli.app import app
from hybrid_tamp.cli.console import output_failed, report_error
from hybrid_tamp.errors import HybridTampError, InputError, Issue


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return its exit status."""
    words = (sys.argv[1:] if arguments is None else arguments) or ["--help"]
    # This is click.UsageError, a class that typer does not export.
    usage_error = cast(type[Exception], typer.BadParameter.__mro__[1])
    try:
        status = app(args=words, prog_name="hybrid-tamp", standalone_mode=False)
        if sys.stdout is not None:  # None if standard output was closed before Python started
            sys.stdout.flush()
    except HybridTampError as error:
        report_error(error, "--json" in words)
        return error.exit_status
    except usage_error as error:
        report_error(_usage_fault(error), "--json" in words)
        return InputError.exit_status
    except (KeyboardInterrupt, typer.Abort):
        typer.echo("interrupted", err=True)
        return 130
    except OSError as error:
        return output_failed(error)
    except SystemExit as end:
        # typer raises SystemExit when the reader of standard output closes the pipe, e.g. `| head`.
        if not isinstance(end.__context__, BrokenPipeError):
            raise
        return output_failed(end.__context__)
    return int(status or 0)


def _usage_fault(error: Exception) -> InputError:
    """Return the error for wrong words on the command line, with the command that prints the help of the verb."""
    message = error.format_message() if hasattr(error, "format_message") else str(error)
    context = getattr(error, "ctx", None)
    verb = "hybrid-tamp" if context is None else context.command_path
    return InputError([Issue("", message.rstrip("."), remedy=f"see '{verb} -h'")])
