"""Why there is no plan, as a document shows it."""

from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.explain.explanation import Explanation, explain_alternatives, explain_wholly
from hybrid_tamp.report.plan_entries import ExplanationEntry, ReasonEntry, SuggestionEntry

SUGGESTING = 4.0
"""How long `plan` looks for a single change with which there would be a plan [s]."""


def explained(task: Task, kind: str, said: str, proven: bool, suggesting: float, most: int = 1) -> ExplanationEntry:
    """Return why there is no plan.

    Args:
        task: the task.
        kind: in a word.
        said: in a sentence.
        proven: whether it is proven; only then single changes are looked for.
        suggesting: how long [s].
        most: how many of them are enough.
    """
    if proven and suggesting:
        found = explain_wholly(task, suggesting, most)
    else:
        found = Explanation(tuple(explain_alternatives(task, proven)), (), complete=False)
    suggestions = [
        SuggestionEntry(
            kind=each.change.kind, what=each.change.what, length=each.length, names=[n for n in each.change.key if n]
        )
        for each in found.suggestions
    ]
    return ExplanationEntry(
        kind=kind,
        message=said,
        reasons=[ReasonEntry(**reason.__dict__) for reason in found.reasons],
        suggestions=suggestions,
        all_looked_at=found.complete,
        together=list(found.together),
    )
