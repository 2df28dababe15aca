"""The places of a file's parts, and the faults found in them.

A part is named by its path, e.g. ``("tokens", "drum", "pose")``. A fault makes its part unsound; what reads a part
asks first, so that one fault is not reported again by everything that depends on it.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NoReturn

from hybrid_tamp.errors import InputError, Issue

KeyPath = tuple[str | int, ...]
"""Keys and indices from the root of a file to one of its parts."""

MOST_FAULTS = 100
"""At most this many faults are listed; of the others, only the number."""
_LONGEST = 60


@dataclass(frozen=True, order=True)
class Mark:
    """A place in a text, counted from 1, columns in characters."""

    line: int = 1
    column: int = 1


def mark_of(text: str, offset: int) -> Mark:
    """Return the place of a character; lines end as in YAML 1.2: CR, LF or both."""
    before = text[:offset].replace("\r\n", "\n").replace("\r", "\n")
    return Mark(before.count("\n") + 1, len(before) - before.rfind("\n"))


class Faults:
    """The places of a file's parts and the faults found so far.

    Attributes:
        source: the file's name as messages show it; None for a task built in Python, whose parts have no line.
        keys: path to the place of its key.
        values: path to the place of its value.
        spans: path to the first character of a scalar value and the one behind its last.
        written: path to a number, truth value or null as the file writes it.
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

    def add(
        self,
        mark: Mark,
        wanted: str,
        came: str = "",
        available: Iterable[str] = (),
        remedy: str = "",
    ) -> None:
        """Note a fault at a place of the file."""
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
        """Note a fault of a part.

        Args:
            path: the part; a fault of a part that is missing is shown at what should hold it.
            wanted: what was expected there.
            came: what was found instead.
            available: the values that would have been accepted.
            remedy: what the user can do.
            key: whether the fault is shown at the part's key rather than at its value.
            sound: whether the part can be read all the same.
        """
        if any(prefix in self._unreadable for prefix in _prefixes(path)):
            return
        if not sound:
            self._taint(path)
        mark = self.mark(path, key=key)
        where = dotted(path) if self.source is None else f"{self.source}:{mark.line}:{mark.column}"
        self._note(mark, where, wanted, came, available, remedy)

    def unreadable(self, path: KeyPath) -> None:
        """Declare that the value of a part could not be read; nothing more is said about it."""
        self._taint(path)
        self._unreadable.add(path)

    def sound(self, path: KeyPath) -> bool:
        """Say whether no fault was found in the part, inside it or in a part that contains it."""
        return path not in self._above and not any(prefix in self._faulty for prefix in _prefixes(path))

    def mark(self, path: KeyPath, *, key: bool = False) -> Mark:
        """Return the place of a part, or of the nearest part that contains it."""
        if path in self.values:
            return self.keys.get(path, self.values[path]) if key else self.values[path]
        while path:
            path = path[:-1]
            if path in self.values:
                return self.keys.get(path, self.values[path])
        return Mark()

    def on_line(self, path: KeyPath, what: str) -> str:
        """Return ``, what on line N`` for a part of a file, nothing for a part of a task built in Python."""
        return "" if self.source is None else f", {what} on line {self.mark(path).line}"

    def shown(self, path: KeyPath, value: Any) -> str:
        """Return a value as messages show it: as the file writes it, shortened."""
        return cut(self.written[path]) if path in self.written else shown(value)

    @property
    def issues(self) -> tuple[Issue, ...]:
        """All faults in the order of the file."""
        return tuple(issue for _, issue in sorted(self._found, key=lambda found: found[0]))

    def raise_if_any(self) -> None:
        """Raise what was found.

        Raises:
            InputError: at least one fault was found.
        """
        if self._found:
            self.raise_all()

    def raise_all(self) -> NoReturn:
        """Raise the faults, but not more than `MOST_FAULTS`.

        Raises:
            InputError: always.
        """
        issues = self.issues
        more = len(issues) - MOST_FAULTS
        if more > 0:
            rest = Issue(issues[MOST_FAULTS].where, f"{more} more faults from here on", remedy="mend the others first")
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
    """Return a path in words, e.g. ``tokens.drum.pose.position[2]``."""
    return "".join(f"[{step}]" if isinstance(step, int) else f".{plain(step)}" for step in path).lstrip(".")


def shown(value: Any) -> str:
    """Return a value as messages show it, e.g. ``'drum'`` or ``[0, 0, 0]``."""
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
    """Return a name without quotes, unless it has characters that would disturb a terminal."""
    return cut(text) if text.isprintable() else shown(text)


def cut(text: str) -> str:
    """Return a text, shortened if it is long."""
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
