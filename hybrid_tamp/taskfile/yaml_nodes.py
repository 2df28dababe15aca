"""Text to plain data and the place of every part: YAML 1.2, core schema, nothing constructed, everything bounded.

The parser's events are built into dictionaries and lists here, with a stack of our own: no object constructor is
ever reached, and no depth of nesting can exhaust Python's stack.
"""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    CollectionEndEvent,
    CollectionStartEvent,
    DocumentStartEvent,
    Event,
    MappingStartEvent,
    ScalarEvent,
)

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.taskfile.places import Faults, KeyPath, Mark, mark_of
from hybrid_tamp.taskfile.yaml_scalars import Unresolvable, resolve, tag_fault
from hybrid_tamp.taskfile.yaml_syntax import add_syntax_fault

MAX_BYTES = 1024 * 1024
"""Largest task file that is read [bytes]."""
MAX_DEPTH = 50
"""Deepest nesting of lists and mappings."""
MAX_NODES = 50_000
"""Most keys, values, lists and mappings of a file: about a thousand tokens, and some seconds of parsing."""


@dataclass(frozen=True)
class Document:
    """One YAML document as plain data.

    Attributes:
        data: dictionaries with text keys, lists, texts, numbers, truth values and None.
        faults: the place of every part, and the faults found while reading.
    """

    data: Any
    faults: Faults


def read_text(path: Path) -> str:
    """Read a file of bounded size as UTF-8.

    Args:
        path: the file.

    Raises:
        InputError: it is missing, a folder, too large, not to be read, or not UTF-8.
    """
    if path.is_dir():
        raise InputError([Issue(str(path), "a task file", "a folder", remedy="name a file in it")])
    try:
        with path.open("rb") as file:
            raw = file.read(MAX_BYTES + 1)
            size = max(os.fstat(file.fileno()).st_size, len(raw))
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError([Issue(str(path), "a task file that can be read", reason.lower())]) from error
    check_size(size, str(path))
    return decode(raw, str(path))


def check_size(size: int, source: str) -> None:
    """Refuse a text of too many bytes.

    Raises:
        InputError: there are more than `MAX_BYTES`.
    """
    if size > MAX_BYTES:
        wanted = f"a task file of at most {MAX_BYTES} bytes ({MAX_BYTES // 1024**2} MiB)"
        raise InputError([Issue(f"{source}:1:1", wanted, f"{size} bytes")])


def decode(raw: bytes, source: str) -> str:
    """Decode UTF-8, with or without a byte order mark.

    Raises:
        InputError: a byte is not UTF-8, with its line and column.
    """
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = error.object[: error.start].decode("utf-8")
        mark = mark_of(before, len(before))
        wanted = "text in UTF-8"
        came = f"the byte 0x{error.object[error.start]:02x}"
        raise InputError(
            [Issue(f"{source}:{mark.line}:{mark.column}", wanted, came, remedy="save the file as UTF-8")]
        ) from error


def parse(text: str, source: str) -> Document:
    """Build plain data from YAML text.

    Args:
        text: the whole file.
        source: its name as messages show it.

    Returns:
        The data with the faults that leave the rest readable, e.g. duplicate keys.

    Raises:
        InputError: the text is empty, not YAML, or nested too deeply.
    """
    builder = _Builder(source)
    parser = YAML(typ="safe", pure=True)
    last = Mark()
    try:
        for event in parser.parse(text):
            last = _mark(event)
            if not builder.take(event):
                break
    # A few malformed escapes and directives escape the parser as Python's own exceptions.
    except (YAMLError, ValueError, OverflowError, IndexError, TypeError, AttributeError) as error:
        add_syntax_fault(builder.faults, text, error, last)
        builder.faults.raise_if_any()
    if not builder.root or builder.root[0] is None:
        keys = "a mapping with the keys domain, tokens and goal"
        builder.faults.add(Mark(), keys, "an empty file")
        builder.faults.raise_if_any()
    return Document(builder.root[0], builder.faults)


def _mark(event: Event) -> Mark:
    return Mark(event.start_mark.line + 1, event.start_mark.column + 1)


@dataclass
class _Frame:
    """A list or mapping that is being filled; `key` is the key whose value comes next, or None."""

    container: dict[str, Any] | list[Any]
    path: KeyPath | None
    is_key: bool = False
    key: str | None = None


class _Builder:
    """Takes events one by one; `root` holds the document's data."""

    def __init__(self, source: str) -> None:
        self.faults = Faults(source)
        self.root: list[Any] = []
        self._frames = [_Frame(self.root, None)]
        self._nodes = 0
        self._documents = 0

    def take(self, event: Event) -> bool:
        """Take one event; return whether to go on."""
        if isinstance(event, DocumentStartEvent):
            return self._document(event)
        if isinstance(event, CollectionEndEvent):
            self._end()
        elif isinstance(event, CollectionStartEvent | ScalarEvent | AliasEvent):
            self._count(event)
            if self._expects_key():
                self._take_key(event)
            else:
                self._take_value(event)
        return True

    def _document(self, event: DocumentStartEvent) -> bool:
        self._documents += 1
        if event.version not in (None, (1, 2)):
            came = f"%YAML {'.'.join(map(str, event.version))}"
            self.faults.add(Mark(), "YAML 1.2", came, remedy="remove the directive")
        if self._documents > 1:
            self.faults.add(_mark(event), "one document a file", "a second one", remedy="split the file")
        return self._documents == 1

    def _count(self, event: Event) -> None:
        self._nodes += 1
        if self._nodes > MAX_NODES:
            self.faults.add(_mark(event), f"a file of at most {MAX_NODES} keys and values", "more")
            self.faults.raise_if_any()
        if isinstance(event, CollectionStartEvent) and len(self._frames) > MAX_DEPTH:
            self.faults.add(_mark(event), f"lists and mappings nested at most {MAX_DEPTH} deep", "more")
            self.faults.raise_if_any()

    def _expects_key(self) -> bool:
        frame = self._frames[-1]
        return isinstance(frame.container, dict) and frame.key is None

    def _take_key(self, event: Event) -> None:
        frame, mark = self._frames[-1], _mark(event)
        if isinstance(event, CollectionStartEvent):
            self._set_key(f"? {mark.line}:{mark.column}", mark, fault="a list or a mapping")
            self._frames.append(_Frame({} if isinstance(event, MappingStartEvent) else [], (), is_key=True))
            return
        if isinstance(event, AliasEvent):
            self._set_key(f"*{event.anchor}", mark, fault=f"the alias *{event.anchor}")
            return
        try:
            value = resolve(event)
        except Unresolvable as error:
            self.faults.add(mark, error.wanted, error.came, remedy=error.remedy)
            self._set_key(str(event.value).encode("ascii", "backslashreplace").decode(), mark)
            self.faults.unreadable((*(frame.path or ()), str(frame.key)))
            return
        if not isinstance(value, str):
            written = event.value or "nothing"
            self.faults.add(mark, "a key is text", written, remedy=f'write "{event.value}" in quotes')
        self._set_key(value if isinstance(value, str) else str(event.value), mark)

    def _set_key(self, key: str, mark: Mark, fault: str = "") -> None:
        frame = self._frames[-1]
        frame.key = key
        path = (*(frame.path or ()), key)
        if fault:
            self.faults.add(mark, "a key is text", fault, remedy="write the key out")
            self.faults.unreadable(path)
        if key in frame.container:
            kind = "two tokens of one name" if frame.path == ("tokens",) else "twice the same key"
            first = self.faults.keys[path].line
            self.faults.add(mark, "every key once", f"{kind}, {key!r}, first on line {first}")
        self.faults.keys.setdefault(path, mark)

    def _take_value(self, event: Event) -> None:
        value: Any = None
        if isinstance(event, CollectionStartEvent):
            value = {} if isinstance(event, MappingStartEvent) else []
        path = self._attach(value, event)
        if isinstance(event, AliasEvent):
            came, remedy = f"the alias *{event.anchor}", "write the value out; a task file has no aliases"
            self.faults.add(_mark(event), "a value", came, remedy=remedy)
            self.faults.unreadable(path)
        fault = tag_fault(event)
        if fault:
            self.faults.add(_mark(event), fault.wanted, fault.came, remedy=fault.remedy)
            self.faults.unreadable(path)
        if isinstance(event, CollectionStartEvent):
            self._frames.append(_Frame(value, path))

    def _attach(self, value: Any, event: Event) -> KeyPath:
        """Put a value where it belongs and return its path; of duplicates the first one stays."""
        frame, mark = self._frames[-1], _mark(event)
        if isinstance(frame.container, list):
            path = () if frame.path is None else (*frame.path, len(frame.container))
            frame.container.append(self._scalar(event, path, mark) if isinstance(event, ScalarEvent) else value)
        else:
            path = (*(frame.path or ()), str(frame.key))
            if isinstance(event, ScalarEvent):
                # An empty value has no place of its own: the parser gives that of whatever comes next.
                mark = mark if event.value or event.style else self.faults.keys[path]
                value = self._scalar(event, path, mark)
            frame.container.setdefault(str(frame.key), value)
            frame.key = None
        self.faults.values.setdefault(path, mark)
        return path

    def _scalar(self, event: ScalarEvent, path: KeyPath, mark: Mark) -> Any:
        try:
            value = resolve(event)
        except Unresolvable as error:
            self.faults.add(mark, error.wanted, error.came, remedy=error.remedy)
            self.faults.unreadable(path)
            return None
        if value is not None and not isinstance(value, str):
            self.faults.written.setdefault(path, event.value)
        return value

    def _end(self) -> None:
        self._frames.pop()


def paths(data: Any, path: KeyPath = ()) -> Iterator[KeyPath]:
    """Yield the path of every part of plain data."""
    yield path
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        yield from paths(value, (*path, key))
