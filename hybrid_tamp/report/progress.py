"""Progress bars on standard error."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn


@contextmanager
def progress_bar(wanted: bool = True) -> Iterator[Callable[[float, str], None]]:
    """Show a progress bar if wanted and standard error is a terminal.

    Yield a function that updates the bar with the fraction of the work that is done (0 to 1) and the current activity.
    """
    columns = (TextColumn("{task.description:<24}"), BarColumn(), TimeElapsedColumn())
    # console.is_terminal is not used, because FORCE_COLOR makes that property true for files.
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not wanted or not console.file.isatty()) as bar:
        task = bar.add_task("planning", total=1.0)

        def tell(share: float, what: str) -> None:
            bar.update(task, completed=share, description=what)

        yield tell
