"""Results as tables: plain text for terminals, HTML for notebooks."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from html import escape
from typing import Any

Rows = Sequence[tuple[str, Any]]
"""Label and value of each line of a table."""


class Tabular:
    """A dataclass that prints as a table; `rows` are its fields unless a subclass overrides them."""

    @property
    def rows(self) -> Rows:
        """The label and the value of each line."""
        return [(field.name.replace("_", " "), getattr(self, field.name)) for field in fields(self)]  # type: ignore[arg-type]

    def __str__(self) -> str:
        return text_table(self.rows)

    def _repr_html_(self) -> str:
        return html_table(self.rows)


def text_table(rows: Rows) -> str:
    """Return a table of two columns as plain text; a label is beside the first line of its value."""
    width = max((len(label) for label, _ in rows), default=0)
    lines = []
    for label, value in rows:
        for number, line in enumerate(lines_of(value) or ["none"]):
            lines.append(f"{label if number == 0 else '':{width}}  {line}".rstrip())
    return "\n".join(lines)


def html_table(rows: Rows) -> str:
    """Return a table of two columns as HTML, with labels and values escaped."""
    body = "".join(
        f"<tr><th>{escape(label)}</th><td>{'<br>'.join(map(escape, lines_of(value) or ['none']))}</td></tr>"
        for label, value in rows
    )
    return f"<table>{body}</table>"


def lines_of(value: Any) -> list[str]:
    """Return a value as lines of text; a sequence or mapping gives the lines of each entry."""
    if isinstance(value, Mapping):
        return [f"{cell(key)}: {cell(each)}" for key, each in value.items()]
    if isinstance(value, Iterable) and not isinstance(value, str):
        return [line for each in value for line in lines_of(each)]
    return cell(value).splitlines()


def cell(value: Any) -> str:
    """Return a single value as text: its `text` or `name` if it has one; numbers have four digits."""
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}"
    said = getattr(value, "text", getattr(value, "name", value))
    return said if isinstance(said, str) else str(value)
