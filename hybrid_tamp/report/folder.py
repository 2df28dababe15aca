"""The folder with the files of a run. A file has a temporary name until the file is complete."""

import json
import os
import tempfile
from pathlib import Path
from typing import Any

from hybrid_tamp.errors import InputError, Issue

RUN_FILES = (
    *("task.yaml", "domain.py", "plan.json", "domain.pddl", "problem.pddl", "plan.pddl", "result.json"),
    *("recording.npz", "events.jsonl", "video.mp4", "video.gif", "convergence.png", "movements.png", "report.html"),
)
NUMBERED_FILES = ("step-*.png", "primitive-[0-9][0-9].json", "mesh-[0-9][0-9].obj")


class RunFolder:
    """Folder for the files of one run."""

    def __init__(self, path: Path) -> None:
        """Use an existing folder. See `create` for new folders."""
        self.path = path

    @classmethod
    def open(cls, folder: "RunFolder | Path | str", *, force: bool = False) -> "RunFolder":
        """Return the given folder, or create the folder if a path is given (see `create`)."""
        return folder if isinstance(folder, RunFolder) else cls.create(Path(folder), force=force)

    @classmethod
    def create(cls, path: Path, *, force: bool = False) -> "RunFolder":
        """Create the folder, or use the existing folder.

        Args:
            path: path of the folder.
            force: whether the folder may contain another run. Call `clear` to remove the files of the other run.

        Raises:
            InputError: the path is a file, the folder cannot be created, or `force` is false and the folder contains
                another run.
        """
        if path.exists() and not path.is_dir():
            raise InputError([Issue(str(path), "the output must be a folder", "a file")])
        try:
            path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError([Issue(str(path), "cannot create the folder", str(error.strerror))]) from error
        old = cls(path)._old()
        if old and not force:
            wanted = "the output folder must not contain another run"
            held = ", ".join(file.name for file in old[:4])
            raise InputError([Issue(str(path), wanted, held, remedy="force=True replaces it")])
        return cls(path)

    def clear(self) -> None:
        """Remove the files of a run and keep all other files.

        Raises:
            InputError: a file cannot be removed.
        """
        for file in self._old():
            try:
                file.unlink()
            except OSError as error:
                raise _unwritable(file, error) from error

    def _old(self) -> list[Path]:
        named = [self.path / name for name in RUN_FILES if (self.path / name).exists()]
        return named + sorted(file for pattern in NUMBERED_FILES for file in self.path.glob(pattern))

    def write_text(self, name: str, text: str) -> Path:
        """Write a text file under a temporary name and rename the complete file.

        Raises:
            InputError: the folder is not writable.
        """
        return self.write_bytes(name, text.encode("utf-8"))

    def write_bytes(self, name: str, content: bytes) -> Path:
        """Write a file under a temporary name and rename the complete file.

        Raises:
            InputError: the folder is not writable.
        """
        target = self.path / name
        try:
            handle, temporary = tempfile.mkstemp(dir=self.path, prefix=f".{name}.")
        except OSError as error:
            raise _unwritable(target, error) from error
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            os.chmod(temporary, 0o644)
            os.replace(temporary, target)
        except BaseException:
            os.unlink(temporary)
            raise
        return target

    def write_json(self, name: str, document: dict[str, Any]) -> Path:
        """Write a JSON document. Raise ValueError if the document contains NaN or infinity."""
        return self.write_text(name, json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n")


def write_new_file(path: Path, text: str, what: str, *, force: bool = False) -> None:
    """Write a text file. The file has a temporary name until all of the text is written.

    Args:
        path: path of the file.
        text: text of the file.
        what: what the file contains, e.g. ``the primitive``, for messages.
        force: whether to replace an existing file.

    Raises:
        InputError: the file exists and `force` is false, or the file cannot be written.
    """
    check_new_file(path, what, force=force)
    RunFolder(path.parent).write_text(path.name, text)


def check_new_file(path: Path, what: str, *, force: bool = False) -> None:
    """Raise `InputError` if a path is a folder, or an existing file and `force` is false. `what` is for messages."""
    if path.is_dir():
        raise InputError([Issue(str(path), f"{what} must be a file", "a folder")])
    if path.exists() and not force:
        wanted, remedy = f"the file for {what} must not exist yet", "force=True replaces the existing file"
        raise InputError([Issue(str(path), wanted, "an existing file", remedy=remedy)])


def check_parent(path: Path, what: str) -> None:
    """Raise `InputError` if the folder of a file does not exist. `what` is for messages."""
    if not path.parent.is_dir():
        came = "which is a file" if path.parent.exists() else "which does not exist"
        raise InputError([Issue(str(path), f"{what} must be in an existing folder", f"{path.parent}, {came}")])


def _unwritable(path: Path, error: OSError) -> InputError:
    return InputError([Issue(str(path), "cannot write to the output folder", str(error.strerror))])
