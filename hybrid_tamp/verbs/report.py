"""The verb ``report``: write the page of a run again."""

import logging
from pathlib import Path

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.report.page import write_page
from hybrid_tamp.verbs.loading import Settings, load

_LOG = logging.getLogger(__name__)


def write_report(directory: Path | str, settings: Settings = Settings()) -> Path:  # noqa: B008
    """Write report.html again from the documents in a folder, and return its path.

    Args:
        directory: the folder that `plan` or `run` wrote.
        settings: name the domain of the task, if it is not installed.

    Raises:
        InputError: a document is missing or wrong, or the folder cannot be written to.
    """
    folder = Path(directory)
    try:
        resting = load(folder / "task.yaml", settings).domain.resting
    except InputError as error:
        # The documents say everything except which block tokens rest in.
        _LOG.info("the page assumes that tokens rest in %s: %s", Domain.resting, error)
        resting = Domain.resting
    return write_page(RunFolder(folder), resting)
