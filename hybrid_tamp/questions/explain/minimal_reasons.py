"""The smallest set of reasons: of what is true about a task without a plan, what it is that counts.

Where single changes give a plan, a reason is left out if there is no plan even with what it complains of taken away.
Where none does, those count that have to be taken away together.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import islice, product

from hybrid_tamp.feasibility.reasons import Reason
from hybrid_tamp.model.predicate import Atom, SymbolSort
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.changes import Change, with_facts
from hybrid_tamp.questions.explain.candidates import answers, parsed
from hybrid_tamp.questions.explain.trial_plans import Trying

MOST_ANSWERS = 4
"""So many ways of taking a reason away are tried before it is left out."""


def needed(task: Task, reasons: Sequence[Reason], trying: Trying) -> list[Reason]:
    """Return the reasons but for which there would be a plan, those left out before being taken away, too.

    Args:
        task: the task.
        reasons: to none of which a suggestion points; there are others to which one does.
        trying: plans changed tasks; when its time is over, the rest is left as it is.
    """
    kept = list(reasons)
    for reason in reversed(reasons):
        without = list(_taken_away(task, reason))
        if without and not trying.over and all(map(trying.excluded, without)):
            kept.remove(reason)
            task = without[0]
    return kept


def _taken_away(task: Task, reason: Reason) -> Iterator[Task]:
    """Yield tasks in which there is nothing to complain of any more."""
    for change in islice(answers(task, reason), MOST_ANSWERS):
        yield change.made()
    if reason.atom:
        # That a hand is on the wrong side of one face is told of one face, and true of others.
        yield with_facts(task, _alike(task, parsed(reason.atom)))


def _alike(task: Task, atom: Atom) -> list[Atom]:
    """Return the atoms that say of the same tokens what an atom says, whatever its symbols."""
    parameters = task.domain.predicate_by_name[atom.predicate].parameters
    choices = [
        parameter.sort.symbols if isinstance(parameter.sort, SymbolSort) else (name,)
        for name, parameter in zip(atom.arguments, parameters, strict=True)
    ]
    return [replace(atom, arguments=names) for names in product(*choices)]


def together(task: Task, reasons: Sequence[Reason], trying: Trying) -> tuple[list[Reason], list[Change]]:
    """Return reasons that, all taken away, leave a plan, and of which none may stay; and the changes that do it.

    Each is taken away by the first change that answers it; where that leaves no plan, all reasons are returned.

    Args:
        task: a task to which no single change gives a plan, as far as is known.
        reasons: why it has none.
        trying: plans changed tasks; when its time is over, the rest is left as it is.
    """
    kept, changes = list(reasons), _answered(task, reasons)
    if len(kept) < 2 or trying.over or not _solved(changes, len(kept), trying):
        return kept, []
    for reason in reversed(reasons):
        fewer = [each for each in kept if each is not reason]
        if trying.over or len(fewer) < 2:
            break
        found = _answered(task, fewer)
        if _solved(found, len(fewer), trying):
            kept, changes = fewer, found
    return kept, changes


def _answered(task: Task, reasons: Iterable[Reason]) -> list[Change]:
    """Return a change for each reason, each of the task that the one before made; fewer where one has no answer."""
    changes: list[Change] = []
    for reason in reasons:
        change = next(iter(answers(task, reason)), None)
        if change is None:
            break
        changes.append(change)
        task = change.made()
    return changes


def _solved(changes: Sequence[Change], wanted: int, trying: Trying) -> bool:
    return len(changes) == wanted and trying.length(changes[-1].made()) is not None
