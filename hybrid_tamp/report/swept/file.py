"""The file of a picture of swept paths. The suffix of its name determines the format."""

from pathlib import Path

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.swept import SweptPlan
from hybrid_tamp.report.folder import RunFolder, check_new_file, check_parent

_FORMATS = ("png", "svg", "pdf")
_WHAT = "the picture of the movements"


def check_picture(path: Path, *, force: bool = False) -> None:
    """Check that a picture can be written to a path.

    Raises:
        InputError: the suffix is unknown, the folder does not exist, or the file exists and `force` is false.
    """
    if path.suffix.lower().lstrip(".") not in _FORMATS:
        wanted = f"the name of the picture must end in {', '.join(f'.{form}' for form in _FORMATS)}"
        raise InputError([Issue(str(path), wanted, path.suffix or "no suffix")])
    check_parent(path, _WHAT)
    check_new_file(path, _WHAT, force=force)


def write_picture(swept: SweptPlan, path: Path) -> None:
    """Write the picture of the movements of a plan.

    Raises:
        InputError: the folder is not writable.
    """
    from hybrid_tamp.report.swept.picture import swept_picture

    RunFolder(path.parent).write_bytes(path.name, swept_picture(swept, path.suffix.lower().lstrip(".")))
