"""Progress lines on standard error."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn


@contextmanager
def progress_bar(doing: str = "planning") -> Iterator[Callable[[float, str], None]]:
    """Show a line with the current activity and the elapsed time, if standard error is a terminal.

    Yield a function that updates the line with the fraction of the work that is done (0 to 1) and the current activity.
    Before the first update, the line shows `doing`.
    """
    columns = (TextColumn("{task.description:<24}"), BarColumn(), TimeElapsedColumn())
    # console.is_terminal is not used, because FORCE_COLOR makes that property true for files.
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not console.file.isatty()) as bar:
        task = bar.add_task(doing, total=None)

        def tell(share: float, what: str) -> None:
            bar.update(task, total=1.0, completed=share, description=what)

        yield tell
