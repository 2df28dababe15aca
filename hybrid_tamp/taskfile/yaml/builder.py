"""Build plain data from parser events. A stack replaces recursion, because Python limits the depth of recursion."""

from dataclasses import dataclass
from typing import Any

from ruamel.yaml.events import (
    AliasEvent,
    CollectionEndEvent,
    CollectionStartEvent,
    DocumentStartEvent,
    Event,
    MappingStartEvent,
    NodeEvent,
    ScalarEvent,
)

from hybrid_tamp.taskfile.places import Faults, KeyPath, Mark, cut, shown
from hybrid_tamp.taskfile.yaml.scalars import Unresolvable, check_tag, resolve

MAX_DEPTH = 50
"""Maximum nesting of lists and mappings."""
MAX_NODES = 50_000
"""Maximum number of keys and values in a file. A file of this size has about 1000 tokens and is parsed in seconds."""


def mark_of_event(event: Event) -> Mark:
    """Return the place at which an event begins."""
    return Mark(event.start_mark.line + 1, event.start_mark.column + 1)


@dataclass
class _Frame:
    """A list or mapping that is being filled. `key` is the key of the next value, or None."""

    container: dict[str, Any] | list[Any]
    path: KeyPath
    key: str | None = None


class Builder:
    """Builder of the data of one document from parser events.

    Attributes:
        roots: list with the data of the document; empty if there is no document.
        faults: the places of all values, and the faults that do not prevent reading the rest of the document.
    """

    def __init__(self, source: str) -> None:
        self.faults = Faults(source)
        self.roots: list[Any] = []
        self._frames = [_Frame(self.roots, ())]
        self._nodes = 0

    def take(self, event: Event) -> bool:
        """Process one event and return whether to continue.

        Raises:
            InputError: the document is nested too deeply or is too large.
        """
        if isinstance(event, DocumentStartEvent):
            return self._take_document(event)
        if isinstance(event, CollectionEndEvent):
            self._frames.pop()
        elif isinstance(event, NodeEvent):
            self._check_bounds(event)
            frame = self._frames[-1]
            if isinstance(frame.container, dict) and frame.key is None:
                self._take_key(event, frame, frame.container)
            else:
                self._take_value(event, frame)
        return True

    def _take_document(self, event: DocumentStartEvent) -> bool:
        if event.version not in (None, (1, 2)):
            came = f"YAML {'.'.join(map(str, event.version))}"
            self.faults.add(Mark(), "a task file must be YAML 1.2", came, remedy="remove the line with %YAML")
        if self.roots:
            self.faults.add(
                mark_of_event(event), "a task file must be one document", "a second document", remedy="split the file"
            )
        return not self.roots

    def _check_bounds(self, event: NodeEvent) -> None:
        self._nodes += 1
        mark = mark_of_event(event)
        if self._nodes > MAX_NODES:
            self.faults.add(mark, f"a task file must have at most {MAX_NODES} keys and values", "more")
            self.faults.raise_all()
        if isinstance(event, CollectionStartEvent) and len(self._frames) > MAX_DEPTH:
            self.faults.add(mark, f"lists and mappings must not be nested more than {MAX_DEPTH} deep", "deeper nesting")
            self.faults.raise_all()

    def _take_key(self, event: NodeEvent, frame: _Frame, container: dict[str, Any]) -> None:
        """Read a key. If the key is not text, record the fault and continue with a substitute key."""
        mark = mark_of_event(event)
        frame.key = self._key(event, frame, mark)
        path = (*frame.path, frame.key)
        if frame.key in container:
            kind = "a second token named" if frame.path == ("tokens",) else "a second key"
            came = f"{kind} {shown(frame.key)}, first on line {self.faults.keys[path].line}"
            self.faults.add(mark, "a key must occur only once", came, remedy="rename or remove one of the keys")
        self.faults.keys.setdefault(path, mark)
        if isinstance(event, CollectionStartEvent):
            self._frames.append(_Frame(_empty(event), path))

    def _key(self, event: NodeEvent, frame: _Frame, mark: Mark) -> str:
        if isinstance(event, ScalarEvent):
            try:
                value = resolve(event)
            except Unresolvable as error:
                self.faults.add(mark, error.wanted, error.came, remedy=error.remedy)
            else:
                if isinstance(value, str):
                    return value
                remedy = f'write "{cut(event.value)}" in quotes' if event.value else "write a key before the ':'"
                self.faults.add(mark, "a key must be text", cut(event.value) or "nothing", remedy=remedy)
                return str(event.value)
        else:
            came = cut(f"*{event.anchor}") if isinstance(event, AliasEvent) else "a list or mapping"
            self.faults.add(mark, "a key must be text", came, remedy="write the key as text")
        # The place makes the substitute key different from every key of the file.
        stand_in = f"? {mark.line}:{mark.column}"
        self.faults.unreadable((*frame.path, stand_in))
        return stand_in

    def _take_value(self, event: NodeEvent, frame: _Frame) -> None:
        mark = mark_of_event(event)
        path = self._next_path(frame)
        if isinstance(event, ScalarEvent) and not event.value and not event.style and path in self.faults.keys:
            # The parser gives an empty value the place of the next event, so the place of the key is used.
            mark = self.faults.keys[path]
        value = self._value(event, path, mark)
        self.faults.values.setdefault(path, mark)
        self.faults.spans.setdefault(path, (event.start_mark.index, event.end_mark.index))
        if isinstance(frame.container, dict):
            # Of two equal keys, keep the value of the first.
            frame.container.setdefault(str(frame.key), value)
            frame.key = None
        else:
            frame.container.append(value)
        if isinstance(event, CollectionStartEvent):
            self._frames.append(_Frame(value, path))

    def _next_path(self, frame: _Frame) -> KeyPath:
        if len(self._frames) == 1:
            return ()
        return (*frame.path, len(frame.container) if frame.key is None else frame.key)

    def _value(self, event: NodeEvent, path: KeyPath, mark: Mark) -> Any:
        """Return the value of a scalar, or an empty list or mapping that the next events fill."""
        try:
            if isinstance(event, ScalarEvent):
                value = resolve(event)
                if value is not None and not isinstance(value, str):
                    self.faults.written.setdefault(path, event.value)
                return value
            if isinstance(event, CollectionStartEvent):
                check_tag(event)
            else:
                wanted = "a task file must not contain aliases"
                raise Unresolvable(wanted, cut(f"*{event.anchor}"), "write the value itself")
        except Unresolvable as error:
            self.faults.add(mark, error.wanted, error.came, remedy=error.remedy)
            self.faults.unreadable(path)
        return _empty(event)


def _empty(event: NodeEvent) -> Any:
    if isinstance(event, CollectionStartEvent):
        return {} if isinstance(event, MappingStartEvent) else []
    return None
