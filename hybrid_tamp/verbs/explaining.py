"""Why there is no plan, as a document shows it."""

from hybrid_tamp.model.explanation import Explanation, Reason
from hybrid_tamp.model.network import slot_text
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.explain.explanation import explain_failure
from hybrid_tamp.report.plan_entries import ExplanationEntry, ReasonEntry, SuggestionEntry

SUGGESTING = 4.0
"""How long `plan` searches for a single change with which there is a plan [s]."""


def explained(task: Task, kind: str, said: str, proven: bool, suggesting: float, most: int = 1) -> ExplanationEntry:
    """Return why there is no plan.

    Args:
        task: the task.
        kind: in a word.
        said: in a sentence.
        proven: whether it is proven; only then single changes are searched for.
        suggesting: how long [s].
        most: how many of them are enough.
    """
    found = explain_failure(task, kind, seconds=suggesting if proven else 0.0, most=most)
    return entry_of(found).model_copy(update={"message": said})


def entry_of(explanation: Explanation) -> ExplanationEntry:
    """Return an explanation as data."""
    suggestions = [
        SuggestionEntry(kind=s.change.kind, what=s.change.what, length=s.length, names=list(s.change.names))
        for s in explanation.suggestions
    ]
    return ExplanationEntry(
        kind=explanation.kind,
        message=explanation.message,
        reasons=[_reason_entry(reason) for reason in explanation.reasons],
        suggestions=suggestions,
        all_looked_at=explanation.complete,
        together=[change.what for change in explanation.together],
    )


def _reason_entry(reason: Reason) -> ReasonEntry:
    lacks = reason.lacks
    return ReasonEntry(
        goal=reason.goal_text,
        block=reason.block,
        kind=reason.kind,
        message=reason.message,
        atom="" if reason.atom is None else reason.atom.text,
        margin=reason.margin,
        unit=reason.unit,
        lacks="" if lacks is None else slot_text(lacks) if isinstance(lacks, tuple) else lacks.name,
    )
