"""Tables of results, as plain text for terminals and as HTML for notebooks."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from html import escape
from typing import Any

Rows = Sequence[tuple[str, Any]]
"""Sequence of (label, value) pairs, one for each row of a table."""


class Tabular:
    """Base class of dataclasses that are printed as a table. By default, each field of the dataclass is a row."""

    @property
    def rows(self) -> Rows:
        """Rows of the table, as pairs of (label, value)."""
        return [(field.name.replace("_", " "), getattr(self, field.name)) for field in fields(self)]  # type: ignore[arg-type]

    def __str__(self) -> str:
        return text_table(self.rows)

    def _repr_html_(self) -> str:
        return html_table(self.rows)


def text_table(rows: Rows) -> str:
    """Return a table of two columns as plain text. The label of a row is in the first line of the row."""
    width = max((len(label) for label, _ in rows), default=0)
    lines = []
    for label, value in rows:
        for number, line in enumerate(lines_of(value) or ["none"]):
            lines.append(f"{label if number == 0 else '':{width}}  {line}".rstrip())
    return "\n".join(lines)


def html_table(rows: Rows) -> str:
    """Return a table of two columns as HTML. Labels and values are escaped."""
    body = "".join(
        f"<tr><th>{escape(label)}</th><td>{'<br>'.join(map(escape, lines_of(value) or ['none']))}</td></tr>"
        for label, value in rows
    )
    return f"<table>{body}</table>"


def lines_of(value: Any) -> list[str]:
    """Return a value as lines of text. A sequence or mapping has at least one line for each entry."""
    if isinstance(value, Mapping):
        return [f"{cell(key)}: {cell(each)}" for key, each in value.items()]
    if isinstance(value, Iterable) and not isinstance(value, str):
        return [line for each in value for line in lines_of(each)]
    return cell(value).splitlines()


def cell(value: Any) -> str:
    """Return the attribute `text` or `name` of a value, or else the value as text. Floats have 4 significant digits."""
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}"
    said = getattr(value, "text", getattr(value, "name", value))
    return said if isinstance(said, str) else str(value)
