"""Write the page of a run again."""

from pathlib import Path

from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.report.page import write_page


def write_report(directory: Path | str) -> Path:
    """Write report.html from the documents in the folder that `plan` or `run` left, and return its path.

    Raises:
        InputError: a document is missing or broken, or the folder cannot be written to.
    """
    return write_page(RunFolder(Path(directory)))
