"""The smallest set of reasons why a task has no plan.

If single changes give a plan, a reason is left out if its removal gives none. If no single change does, those reasons
are kept that have to be removed together.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice, product

from hybrid_tamp.model.change import Change
from hybrid_tamp.model.explanation import Reason
from hybrid_tamp.model.predicate import SymbolSort
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.changes import apply_change, with_facts
from hybrid_tamp.questions.explain.candidates import find_answers
from hybrid_tamp.questions.explain.trial_plans import TrialPlanner

MOST_ANSWERS = 4
"""Number of ways to remove a reason that are tried before it is left out."""


def keep_necessary(task: Task, reasons: Sequence[Reason], trials: TrialPlanner) -> list[Reason]:
    """Return the reasons whose removal would give a plan; reasons that are left out stay removed meanwhile.

    Args:
        task: the task.
        reasons: reasons to which no suggestion points.
        trials: plans changed tasks; when its time is over, the remaining reasons are kept.
    """
    kept = list(reasons)
    for reason in reversed(reasons):
        without = list(_tasks_without(task, reason))
        if without and not trials.over and all(map(trials.proves_unsolvable, without)):
            kept.remove(reason)
            task = without[0]
    return kept


def _tasks_without(task: Task, reason: Reason) -> Iterator[Task]:
    """Yield tasks in which the reason is removed."""
    for change in islice(find_answers(task, reason), MOST_ANSWERS):
        yield apply_change(task, change)
    if reason.atom is not None:
        # A reason names one symbol, e.g. the face on whose wrong side a hand is, and may hold for others, too.
        parameters = task.domain.predicate_by_name[reason.atom.predicate].parameters
        choices = [
            parameter.sort.symbols if isinstance(parameter.sort, SymbolSort) else (name,)
            for name, parameter in zip(reason.atom.arguments, parameters, strict=True)
        ]
        yield with_facts(task, [replace(reason.atom, arguments=names) for names in product(*choices)])


def remove_together(task: Task, reasons: Sequence[Reason], trials: TrialPlanner) -> tuple[list[Reason], list[Change]]:
    """Return the reasons that must all be removed to give a plan, and the changes that remove them.

    Each is removed by the first change that answers it; if that gives no plan, all reasons are returned.

    Args:
        task: a task to which no known single change gives a plan.
        reasons: why it has none.
        trials: plans changed tasks; when its time is over, the remaining reasons are kept.
    """
    kept, changes = list(reasons), _find_changes(task, reasons, trials)
    if not changes:
        return kept, []
    for reason in reversed(reasons):
        fewer = [each for each in kept if each is not reason]
        if trials.over or len(fewer) < 2:
            break
        if found := _find_changes(task, fewer, trials):
            kept, changes = fewer, found
    return kept, changes


def _find_changes(task: Task, reasons: Sequence[Reason], trials: TrialPlanner) -> list[Change]:
    """Return one change for each of several reasons if there is a plan with all of them, else an empty list.

    The changes are applied one after the other.
    """
    changes: list[Change] = []
    if len(reasons) < 2 or trials.over:
        return []
    for reason in reasons:
        change = next(iter(find_answers(task, reason)), None)
        if change is None:
            return []
        changes.append(change)
        task = apply_change(task, change)
    return changes if trials.length(task) is not None else []
