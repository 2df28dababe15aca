"""The verb ``new``: write the files of a small working domain, from which authors start."""

from importlib.resources import files
from pathlib import Path

from hybrid_tamp.errors import InputError, Issue

_EXAMPLES = "hybrid_tamp_examples"
"""Package with the example domains."""
_DOMAIN = "sweeping"
_FILES = ("domain.py", "task.yaml", "test_domain.py")


def new(folder: Path | str) -> tuple[Path, ...]:
    """Write a domain, a task and the tests of the domain into a folder, and return the paths of the files.

    Raises:
        InputError: a file exists, or the folder or a file cannot be written.
    """
    targets = tuple(Path(folder) / name for name in _FILES)
    existing = [target.name for target in targets if target.exists()]
    if existing:
        wanted = f"the folder must not contain {', '.join(_FILES)}"
        raise InputError([Issue(str(folder), wanted, ", ".join(existing), remedy="choose another folder")])
    source = files(_EXAMPLES) / _DOMAIN
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
        for target in targets:
            target.write_text((source / target.name).read_text(encoding="utf-8"), encoding="utf-8")
    except OSError as error:
        raise InputError([Issue(str(folder), "cannot write the files", str(error.strerror))]) from error
    return targets
