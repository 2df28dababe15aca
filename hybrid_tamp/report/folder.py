"""The folder with the files of a run; every file appears under its name only when it is complete."""

import json
import os
import tempfile
from pathlib import Path
from typing import Any

from hybrid_tamp.errors import InputError, Issue

RUN_FILES = (
    *("task.yaml", "plan.json", "domain.pddl", "problem.pddl", "plan.pddl", "result.json"),
    *("recording.npz", "events.jsonl", "video.mp4", "convergence.png", "report.html"),
)
NUMBERED_FILES = ("step-*.png", "primitive-[0-9][0-9].json", "mesh-[0-9][0-9].obj")


class RunFolder:
    """A folder for the files of one run."""

    def __init__(self, path: Path) -> None:
        """Use an existing folder; `create` makes one."""
        self.path = path

    @classmethod
    def open(cls, folder: "RunFolder | Path | str", *, force: bool = False) -> "RunFolder":
        """Return a given folder, or create the folder of a path (see `create`)."""
        return folder if isinstance(folder, RunFolder) else cls.create(Path(folder), force=force)

    @classmethod
    def create(cls, path: Path, *, force: bool = False) -> "RunFolder":
        """Make the folder, or use an existing one.

        Args:
            path: the folder.
            force: whether the folder may hold the files of another run, which `clear` removes.

        Raises:
            InputError: the path is a file, the folder cannot be made, or it holds another run and `force` is false.
        """
        if path.exists() and not path.is_dir():
            raise InputError([Issue(str(path), "the output must be a folder", "a file")])
        try:
            path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError([Issue(str(path), "a folder that can be made", str(error.strerror))]) from error
        old = cls(path)._old()
        if old and not force:
            wanted, held = "an output folder without another run", ", ".join(file.name for file in old[:4])
            raise InputError([Issue(str(path), wanted, held, remedy="force=True replaces it")])
        return cls(path)

    def clear(self) -> None:
        """Remove the files of a run; other files stay.

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
        """Write a text file under a temporary name, then rename it.

        Raises:
            InputError: the folder cannot be written to.
        """
        return self.write_bytes(name, text.encode("utf-8"))

    def write_bytes(self, name: str, content: bytes) -> Path:
        """Write a file under a temporary name, then rename it.

        Raises:
            InputError: the folder cannot be written to.
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
        """Write a JSON document; NaN and infinity raise ValueError."""
        return self.write_text(name, json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n")


def _unwritable(path: Path, error: OSError) -> InputError:
    return InputError([Issue(str(path), "an output folder that can be written to", str(error.strerror))])
