"""The places and the faults of the values in a file.

A path identifies a value, e.g. ``("tokens", "drum", "pose")``. A value with a fault is unsound. Readers skip unsound
values, so that the same fault is not reported again.
"""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, NoReturn

from hybrid_tamp.errors import InputError, Issue

KeyPath = tuple[str | int, ...]
"""Path from the root of a file to a value, as a tuple of keys and indices."""

MOST_FAULTS = 100
"""Maximum number of faults that a message lists. Further faults are only counted."""
_LONGEST = 60


@dataclass(frozen=True, order=True)
class Mark:
    """A place in a text. Lines and columns are counted from 1, and columns are counted in characters."""

    line: int = 1
    column: int = 1


def mark_of(text: str, offset: int) -> Mark:
    """Return the place of the character at an offset. Lines end with CR, LF or both, as in YAML 1.2."""
    before = text[:offset].replace("\r\n", "\n").replace("\r", "\n")
    return Mark(before.count("\n") + 1, len(before) - before.rfind("\n"))


class Faults:
    """The places of a file's values and the faults found so far.

    Attributes:
        source: name of the file in messages; None for a task built in Python, whose values have no lines.
        keys: maps each path to the place of the key.
        values: maps each path to the place of the value.
        spans: maps the path of each scalar to its character offsets (start, end); the end is exclusive.
        written: maps the path of each number, truth value or null to its text in the file.
    """

    def __init__(self, source: str | None = None) -> None:
        self.source = source
        self.keys: dict[KeyPath, Mark] = {}
        self.values: dict[KeyPath, Mark] = {}
        self.spans: dict[KeyPath, tuple[int, int]] = {}
        self.written: dict[KeyPath, str] = {}
        self._found: dict[tuple[Mark, Issue], None] = {}
        self._faulty: set[KeyPath] = set()
        self._above: set[KeyPath] = set()
        self._unreadable: set[KeyPath] = set()

    def add(self, mark: Mark, wanted: str, came: str = "", available: Iterable[str] = (), remedy: str = "") -> None:
        """Record a fault at a place of the file."""
        self._note(mark, f"{self.source}:{mark.line}:{mark.column}", wanted, came, available, remedy)

    def at(
        self,
        path: KeyPath,
        wanted: str,
        came: str = "",
        available: Iterable[str] = (),
        remedy: str = "",
        *,
        key: bool = False,
        sound: bool = False,
    ) -> None:
        """Record a fault of a value.

        Args:
            path: path of the value. The fault of a missing value is shown at the value that should contain it.
            wanted: the requirement that is not met.
            came: the value that was given.
            available: the accepted values.
            remedy: advice on how to repair the fault.
            key: whether to show the fault at the key instead of the value.
            sound: whether the value can be used despite the fault.
        """
        if any(prefix in self._unreadable for prefix in _prefixes(path)):
            return
        if not sound:
            self._taint(path)
        mark = self.mark(path, key=key)
        where = dotted(path) if self.source is None else f"{self.source}:{mark.line}:{mark.column}"
        self._note(mark, where, wanted, came, available, remedy)

    @contextmanager
    def collecting(self, path: KeyPath) -> Iterator[None]:
        """Record the issues of an `InputError` raised inside the context as faults of a value."""
        try:
            yield
        except InputError as error:
            for issue in error.issues:
                wanted = issue.wanted if issue.where in ("", *path) else f"{issue.where}: {issue.wanted}"
                self.at(path, wanted, issue.came, issue.available, issue.remedy)

    def unreadable(self, path: KeyPath) -> None:
        """Declare a value unreadable. Later faults of the value are ignored."""
        self._taint(path)
        self._unreadable.add(path)

    def sound(self, path: KeyPath) -> bool:
        """Return whether the value, all values inside it and all values that contain it are without faults."""
        return path not in self._above and not any(prefix in self._faulty for prefix in _prefixes(path))

    def mark(self, path: KeyPath, *, key: bool = False) -> Mark:
        """Return the place of a value. If the place is unknown, return the place of the innermost enclosing value."""
        if path in self.values:
            return self.keys.get(path, self.values[path]) if key else self.values[path]
        while path:
            path = path[:-1]
            if path in self.values:
                return self.keys.get(path, self.values[path])
        return Mark()

    def on_line(self, path: KeyPath, what: str) -> str:
        """Return the text ``, what on line N`` for a value of a file; empty for a task built in Python."""
        return "" if self.source is None else f", {what} on line {self.mark(path).line}"

    def shown(self, path: KeyPath, value: Any) -> str:
        """Return a value as the file writes it, shortened for messages."""
        return cut(self.written[path]) if path in self.written else shown(value)

    @property
    def issues(self) -> tuple[Issue, ...]:
        """All faults in the order of the file."""
        return tuple(issue for _, issue in sorted(self._found, key=lambda found: found[0]))

    def raise_if_any(self) -> None:
        """Raise an `InputError` with the faults found so far, if there are any."""
        if self._found:
            self.raise_all()

    def raise_all(self) -> NoReturn:
        """Raise an `InputError` with the first `MOST_FAULTS` faults."""
        issues = self.issues
        more = len(issues) - MOST_FAULTS
        if more > 0:
            remedy = "correct the faults above first"
            rest = Issue(issues[MOST_FAULTS].where, f"{more} more faults come after this place", remedy=remedy)
            issues = (*issues[:MOST_FAULTS], rest)
        raise InputError(issues)

    def _note(self, mark: Mark, where: str, wanted: str, came: str, available: Iterable[str], remedy: str) -> None:
        self._found[mark, Issue(where, wanted, came, tuple(available), remedy)] = None

    def _taint(self, path: KeyPath) -> None:
        self._faulty.add(path)
        self._above.update(_prefixes(path))


def _prefixes(path: KeyPath) -> list[KeyPath]:
    return [path[:length] for length in range(len(path) + 1)]


def dotted(path: KeyPath) -> str:
    """Return a path as text, e.g. ``tokens.drum.pose.position[2]``."""
    return "".join(f"[{step}]" if isinstance(step, int) else f".{plain(step)}" for step in path).lstrip(".")


def shown(value: Any) -> str:
    """Return a value for messages, e.g. ``'drum'`` or ``[0, 0, 0]``."""
    if isinstance(value, str):
        return repr(cut(value))
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list):
        short = len(value) <= 6 and not any(isinstance(item, dict | list) for item in value)
        return f"[{', '.join(map(shown, value))}]" if short else f"a list of {len(value)}"
    return cut(str(value))


def plain(text: str) -> str:
    """Return a name without quotes, or with quotes and escapes if it has unprintable characters."""
    return cut(text) if text.isprintable() else shown(text)


def cut(text: str) -> str:
    """Return a text shortened to at most 60 characters."""
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
