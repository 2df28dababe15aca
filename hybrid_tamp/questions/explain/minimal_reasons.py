"""Selection of a minimal set of reasons why a task has no plan.

If a single change makes the task solvable, a reason is kept only if removing its cause may make the task solvable. If
no single change suffices, the reasons whose causes must be removed together are kept.
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
"""Maximum number of changes that are tested for each reason. Each of these changes removes the cause of the reason."""


def keep_necessary(task: Task, reasons: Sequence[Reason], trials: TrialPlanner) -> list[Reason]:
    """Return the reasons for which removing the cause may make the task solvable.

    Once a reason is dropped, its cause stays removed from the task in which the remaining reasons are examined.

    Args:
        task: a task that has no plan.
        reasons: reasons that no suggestion removes.
        trials: planner for changed tasks. Once its count is used up, all remaining reasons are kept.
    """
    kept = list(reasons)
    for reason in reversed(reasons):
        without = list(_tasks_without(task, reason))
        if without and not trials.over and all(map(trials.proves_unsolvable, without)):
            kept.remove(reason)
            task = without[0]
    return kept


def _tasks_without(task: Task, reason: Reason) -> Iterator[Task]:
    """Yield tasks in which the cause of the reason is removed."""
    for change in islice(find_answers(task, reason), MOST_ANSWERS):
        yield apply_change(task, change)
    if reason.atom is not None and task.domain.predicate_by_name[reason.atom.predicate].static:
        # The reason names one symbol, for example one face of a box, but may also hold for other symbols.
        parameters = task.domain.predicate_by_name[reason.atom.predicate].parameters
        choices = [
            parameter.sort.symbols if isinstance(parameter.sort, SymbolSort) else (name,)
            for name, parameter in zip(reason.atom.arguments, parameters, strict=True)
        ]
        yield with_facts(task, [replace(reason.atom, arguments=names) for names in product(*choices)])


def remove_together(task: Task, reasons: Sequence[Reason], trials: TrialPlanner) -> tuple[list[Reason], list[Change]]:
    """Return the reasons whose causes must be removed together, and the changes that remove these causes.

    Each reason is removed by the first change that addresses it. If these changes together do not make the task
    solvable, all reasons are returned without changes.

    Args:
        task: a task that no known single change makes solvable.
        reasons: reasons why the task has no plan.
        trials: planner for changed tasks. Once its count is used up, all remaining reasons are kept.
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
    """Return one change per reason if all changes together make the task solvable, else an empty list."""
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


def plan_atoms_alone(task: Task, reasons: Sequence[Reason], trials: TrialPlanner) -> Iterator[Reason]:
    """Yield the reasons. A reason that blames all goal atoms together is replaced if a single atom has no plan.

    Args:
        task: a task that has no plan.
        reasons: reasons why the task has no plan.
        trials: planner for the tasks with a single goal atom. Once its count is used up, the reasons are not changed.
    """
    for reason in reasons:
        several = reason.kind == "together" and len(reason.goal) > 1
        alone = [a for a in reason.goal if several and trials.proves_unsolvable(task.replaced(goal=(a,)))]
        for atom in alone:
            message = (
                f"no fact rules out {atom.text}, but no plan achieves {atom.text}, even without the other goal atoms"
            )
            yield replace(reason, goal=(atom,), message=message)
        if not alone:
            yield reason
