"""Progress bars for people, on standard error."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn


@contextmanager
def progress_bar(wanted: bool = True) -> Iterator[Callable[[float, str], None]]:
    """Show a bar within the context, which yields a function of the finished share, 0 to 1, and the current activity.

    Args:
        wanted: whether to show a bar; a file never gets one.
    """
    columns = (TextColumn("{task.description:<24}"), BarColumn(), TimeElapsedColumn())
    # Not console.is_terminal, which FORCE_COLOR makes true for a file as well.
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not wanted or not console.file.isatty()) as bar:
        task = bar.add_task("planning", total=1.0)

        def tell(share: float, what: str) -> None:
            bar.update(task, completed=share, description=what)

        yield tell
