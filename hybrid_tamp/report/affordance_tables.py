"""Tables for people who ask about a task."""

from collections.abc import Iterable

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from hybrid_tamp.report.affordance_documents import (
    AffordanceEntry,
    AffordancesDocument,
    ExplainDocument,
    ImplicationEntry,
)
from hybrid_tamp.report.tables import explanation_text


def explain_text(document: ExplainDocument) -> RenderableType:
    """Return why there is no plan, or a line a token that says why it is in the plan or not."""
    if document.explanation is not None:
        return explanation_text(document.explanation)
    table = Table(title=f"Why {document.task} has the plan that it has", title_justify="left", header_style="bold")
    for heading in ("token", "in the plan", "why"):
        table.add_column(heading, overflow="fold")
    for entry in document.tokens:
        # Programs are told the whole chain; people each instance once, with the nearest that needs it.
        others = {link.instance: link for link in reversed(entry.links)}
        others.pop(entry.links[0].instance if entry.links else "", None)
        said = [f"{entry.why}."]
        said += [f"{link.instance} for {link.needed_by}: {link.atom}" for link in reversed(others.values())]
        table.add_row(Text(entry.token), "yes" if entry.used else "no", Text("\n".join(said)))
    return table


def affordances_table(document: AffordancesDocument) -> RenderableType:
    """Return which object affords which block, and what each question changes."""
    parts: list[RenderableType] = []
    if document.affordances:
        parts.append(_affordances(f"{document.task}, {document.view} view", document.affordances))
    else:
        parts.append(Text(f"{document.task}, {document.view} view: no object affords anything."))
    if document.implied:
        parts.append(_implied(document.implied))
    for question in document.what_if:
        changed = [("becomes possible", question.gained), ("is lost", question.lost)]
        if not question.gained and not question.lost:
            parts.append(Text(f"{question.question}: nothing changes."))
        parts += [_affordances(f"{question.question}: what {what}", entries) for what, entries in changed if entries]
    return Group(*parts)


def _affordances(title: str, entries: Iterable[AffordanceEntry]) -> Table:
    table = Table(title=title, title_justify="left", header_style="bold")
    for heading in ("object", "affords", "as", "to", "e.g. with"):
        table.add_column(heading, overflow="fold")
    for entry in entries:
        to = ", ".join(entry.agents) or "-"
        table.add_row(*map(Text, (entry.object, entry.block, entry.slot, to, _witness(entry.witness, entry.slot))))
    return table


def _implied(entries: Iterable[ImplicationEntry]) -> Table:
    title = "What an agent seen acting implies for one with the same capability classes"
    table = Table(title=title, title_justify="left", header_style="bold")
    for heading in ("seen", "with", "in", "so", "can too?", "e.g. with"):
        table.add_column(heading, overflow="fold")
    for entry in entries:
        said = "yes" if entry.holds else "by class, but a feasibility fact fails"
        witness = _witness(entry.witness, entry.slot)
        table.add_row(*map(Text, (entry.seen, entry.object, entry.block, entry.observer, said, witness)))
    return table


def _witness(witness: dict[str, str], slot: str) -> str:
    return ", ".join(f"{role}={value}" for role, value in witness.items() if role != slot) or "-"
