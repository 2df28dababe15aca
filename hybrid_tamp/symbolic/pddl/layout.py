"""How PDDL text is laid out, of either kind of problem: sections with a line each, indented."""

from collections.abc import Iterable

from hybrid_tamp.symbolic.pddl.operators import Typed


def lay_out_definition(head: str, sections: Iterable[str], comments: Iterable[tuple[str, str]]) -> str:
    """Return a whole file from its sections, leaving out the empty ones, with comments on names above."""
    body = "\n".join(indent(section) for section in sections if section)
    return f"{_lay_out_comments(comments)}(define {head}\n{body}\n)\n"


def lay_out_section(keyword: str, lines: Iterable[str]) -> str:
    """Return ``(keyword line...)`` with a line each, or an empty text where there are no lines."""
    body = "\n".join(map(indent, lines))
    return f"({keyword}\n{body}\n)" if body else ""


def lay_out_conjunction(terms: Iterable[str]) -> str:
    """Return ``(and term...)`` with a line each; an empty conjunction is true."""
    return lay_out_section("and", terms) or "(and)"


def lay_out_term(words: Iterable[str]) -> str:
    """Return ``(first second ...)`` on one line, leaving out what is empty."""
    return f"({' '.join(filter(None, words))})"


def lay_out_typed(names: Iterable[Typed]) -> str:
    """Return ``?a - t ?b - u`` on one line."""
    return " ".join(f"{name} - {kind}" for name, kind in names)


def group_by_type(names: Iterable[Typed]) -> list[str]:
    """Return a line ``a b - type`` for each type, in the order in which types first appear."""
    groups: dict[str, list[str]] = {}
    for name, kind in names:
        groups.setdefault(kind, []).append(name)
    return [f"{' '.join(members)} - {kind}" for kind, members in groups.items()]


def indent(text: str) -> str:
    """Return the text one level deeper."""
    return "\n".join("  " + line for line in text.splitlines())


def _lay_out_comments(comments: Iterable[tuple[str, str]]) -> str:
    """Return a comment line for each name that differs; quoted, so that no name can end its line."""
    lines = [f";   {name} is {own!r}" for name, own in comments if name != own]
    return "\n".join(["; Names here and in the task:", *lines, ""]) if lines else ""
