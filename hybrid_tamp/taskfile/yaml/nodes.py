"""Read YAML 1.2 as plain data with the place of every value. A file must use the core schema and be of limited size."""

import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.taskfile.places import Faults, Mark, mark_of, shown
from hybrid_tamp.taskfile.yaml.builder import Builder, mark_of_event
from hybrid_tamp.taskfile.yaml.syntax import add_syntax_fault

MAX_BYTES = 1024 * 1024
"""Maximum size of a task file [bytes]."""
MAX_RUN = 10_000
"""Maximum length of a word in characters. The parser may take time quadratic in the length of a word."""
_ENDLESS = re.compile(rf"[^\s\"']{{{MAX_RUN + 1}}}")

_TASK_FILE = "a task file must be a mapping with the keys domain, tokens and goal"


@dataclass(frozen=True)
class Document:
    """One YAML document as plain data.

    Attributes:
        data: root mapping of mappings with text keys, lists, texts, numbers, truth values and None.
        faults: the places of all values, and the faults found while reading.
    """

    data: dict[str, Any]
    faults: Faults


def read_text(path: Path, what: str = "a task file", most: int = MAX_BYTES) -> str:
    """Read a file of bounded size as UTF-8.

    Args:
        path: path of the file.
        what: kind of the file in messages.
        most: maximum size of the file [bytes].

    Raises:
        InputError: the file is missing, a folder, too large, unreadable or not UTF-8.
    """
    try:
        if path.is_dir():
            raise InputError([Issue(str(path), f"must be {what}", "a folder", remedy="give the path of a file")])
        with open(path, "rb", opener=_open_at_once) as file:
            raw = file.read(most + 1)
            size = max(os.fstat(file.fileno()).st_size, len(raw))
    except FileNotFoundError as error:
        raise InputError([Issue(str(path), f"must be {what}", "no file of this name")]) from error
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError([Issue(str(path), "cannot read the file", reason)]) from error
    if size > most:
        wanted = f"{what} must have at most {most} bytes ({most // 1024**2} MiB)"
        raise InputError([Issue(f"{path}:1:1", wanted, f"{size} bytes")])
    return decode(raw, str(path), what)


def _open_at_once(name: str, flags: int) -> int:
    """Open a file without blocking. A pipe without a writer is read as an empty file."""
    descriptor = os.open(name, flags | getattr(os, "O_NONBLOCK", 0))
    os.set_blocking(descriptor, True)
    return descriptor


def decode(raw: bytes, source: str, what: str = "a task file") -> str:
    """Decode UTF-8, with or without a byte order mark.

    Raises:
        InputError: a byte is not UTF-8. The message names the line and column of the byte.
    """
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        # The codec counts bytes from the end of the byte order mark.
        before = error.object[: error.start].decode("utf-8")
        mark = mark_of(before, len(before))
        where, came = f"{source}:{mark.line}:{mark.column}", f"the byte 0x{error.object[error.start]:02x}"
        raise InputError([Issue(where, f"{what} must be UTF-8", came, remedy="save the file as UTF-8")]) from error


def parse(text: str, source: str, wanted: str = _TASK_FILE) -> Document:
    """Build plain data from YAML text.

    Args:
        text: content of the file.
        source: name of the file in messages.
        wanted: message for a text that is not a mapping.

    Returns:
        The data, and the faults that do not prevent reading the rest of the text, e.g. duplicate keys.

    Raises:
        InputError: the text is empty, not YAML, not a mapping, nested too deeply or too large.
    """
    builder, last = Builder(source), Mark()
    if run := _ENDLESS.search(text):
        limit = f"a word must have at most {MAX_RUN} characters"
        builder.faults.add(mark_of(text, run.start()), limit, "a longer word", remedy="put blanks in between")
        builder.faults.raise_all()
    try:
        for event in YAML(typ="safe", pure=True).parse(text):
            last = mark_of_event(event)
            if not builder.take(event):
                break
    # The parser raises Python's own exceptions for malformed escapes and directives.
    except (YAMLError, ValueError, OverflowError, IndexError, TypeError, AttributeError) as error:
        add_syntax_fault(builder.faults, text, error, last)
        builder.faults.raise_all()
    root = builder.roots[0] if builder.roots else None
    if not isinstance(root, dict):
        if root is None and builder.faults.sound(()):
            builder.faults.add(Mark(), wanted, "an empty file")
        else:
            builder.faults.at((), wanted, shown(root))
        builder.faults.raise_all()
    return Document(root, builder.faults)
