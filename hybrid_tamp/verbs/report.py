"""The verb ``report``: write the report page of a run again."""

import logging
from pathlib import Path

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.report.page import write_page
from hybrid_tamp.verbs.loading import Settings, load

_LOG = logging.getLogger(__name__)


def write_report(directory: Path | str, settings: Settings = Settings()) -> Path:  # noqa: B008
    """Write report.html from the documents in a folder and return its path.

    Args:
        directory: the folder that `plan` or `run` wrote.
        settings: settings that name the domain of the task, if the domain is not installed.

    Raises:
        InputError: a document is missing or wrong, or the folder is not writable.
    """
    folder = Path(directory)
    try:
        resting = load(folder / "task.yaml", settings).domain.resting
    except InputError as error:
        # The documents contain everything that the page needs except the name of the resting block.
        _LOG.info("the report page assumes that the resting block is %s: %s", Domain.resting, error)
        resting = Domain.resting
    return write_page(RunFolder(folder), resting)
