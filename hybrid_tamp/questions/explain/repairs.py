"""Search for single changes that make a task solvable.

The delete relaxation of a changed task, in which blocks delete no atoms, is solved in a few hundredths of a second. If
the relaxation has no plan, the change is useless. Otherwise, the planner searches for a plan of the changed task that
obeys the law of assignment. If the task is unsolvable only because blocks delete atoms, the relaxation proves nothing.
The planner then tries many edges or facts at once. If the whole group does not help, no change of the group helps.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.change import (
    AddEdge,
    Change,
    CopyToken,
    GrantFact,
    IdealToken,
    JoinClass,
    SetFactor,
    SetProperty,
)
from hybrid_tamp.model.explanation import Reason, Suggestion
from hybrid_tamp.model.facts import StaticFacts
from hybrid_tamp.model.network import slot_text
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.changes import apply_change, apply_together
from hybrid_tamp.questions.explain.candidates import points_to, propose_changes
from hybrid_tamp.questions.explain.trial_plans import TrialPlanner
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.relaxation import may_be_solvable

OF_A_KIND = 2
"""Largest number of suggested changes of the same kind."""


@dataclass(frozen=True)
class Repairs:
    """The result of a search for single changes.

    Attributes:
        suggestions: changes that make the task solvable, in the order in which they were found.
        complete: whether the search examined all changes, or found the requested number of changes.
    """

    suggestions: tuple[Suggestion, ...]
    complete: bool


def find_repairs(task: Task, reasons: Sequence[Reason], trials: TrialPlanner, most: int) -> Repairs:
    """Search for single changes that make a task solvable.

    Args:
        task: a task that has no plan.
        reasons: known reasons why the task has no plan. Changes that remove these reasons are tried first.
        trials: planner for changed tasks. Once its count is used up, no further change is tried.
        most: number of suggested changes after which the search stops.
    """
    found: list[Suggestion] = []
    kinds, copied = Counter[str](), set[str]()
    for change in _Sieve(task, reasons, trials).promising(propose_changes(task, reasons)):
        if trials.over:
            return Repairs(tuple(found), complete=False)
        # At most one copy of each token is suggested.
        source = change.like if isinstance(change, CopyToken) else None
        if change is None or kinds[change.kind] == OF_A_KIND or (source is not None and source.name in copied):
            continue
        length = trials.length(apply_change(task, change))
        if length is not None:
            found.append(Suggestion(change, length))
            copied |= {source.name} if source is not None else set()
            kinds[change.kind] += 1
        if len(found) == most:
            break
    return Repairs(tuple(found), complete=True)


class _Sieve:
    """A filter that removes changes which are proven to be useless."""

    def __init__(self, task: Task, reasons: Iterable[Reason], trials: TrialPlanner) -> None:
        self._task = task
        self._known = StaticFacts(task)
        self._trials = trials
        # Reasons of every kind except "together" prove that the delete relaxation is unsolvable.
        self._relaxed_unsolvable = any(reason.kind != "together" for reason in reasons) or not self._possible([])

    def promising(self, changes: Iterable[Change]) -> Iterator[Change | None]:
        """Yield the changes that may be useful. Yield None after other tests, so that the caller checks the count."""
        for kind, group in groupby(changes, key=lambda change: change.kind):
            if kind not in ("edge", "fact"):
                yield from (change if self._possible([change]) else None for change in group)
            elif self._relaxed_unsolvable:
                yield from self._split(list(group), self._possible)
            else:
                # Planning takes long, so the first change is tried alone, and each further group is twice as large.
                rest, size = list(group), 1
                while rest:
                    yield from self._split(rest[:size], self._may_be_planned)
                    rest, size = rest[size:], 2 * size

    def _split(self, group: list[Change], may_help: Callable[[list[Change]], bool]) -> Iterator[Change | None]:
        """Yield the changes of a group that may be useful. The group is bisected, and useless halves are skipped."""
        if not may_help(group):
            yield None
        elif len(group) == 1:
            yield from group
        else:
            middle = len(group) // 2
            yield None
            yield from self._split(group[:middle], may_help)
            yield from self._split(group[middle:], may_help)

    def _possible(self, group: list[Change]) -> bool:
        self._trials.deadline.check()
        compilation = compile_task(apply_together(self._task, group))
        if not group or isinstance(group[0], AddEdge):
            # Edges do not change the feasibility facts, which take most of the time to compute.
            compilation = replace(compilation, feasible=self._known)
        return may_be_solvable(compilation.problem)

    def _may_be_planned(self, group: list[Change]) -> bool:
        # A single change needs no test here, because the caller plans it anyway.
        return len(group) == 1 or not self._trials.proves_unsolvable(apply_together(self._task, group))


def find_counterfactual_reasons(
    task: Task, reasons: Iterable[Reason], suggestions: Iterable[Suggestion]
) -> list[Reason]:
    """Return an additional reason for each suggested change that no given reason explains."""
    found: list[Reason] = []
    for suggestion in suggestions:
        if not any(points_to(reason, suggestion.change) for reason in (*reasons, *found)):
            found.append(_counterfactual(task, suggestion.change))
    return found


def _counterfactual(task: Task, change: Change) -> Reason:
    match change:
        case AddEdge(source, target):
            message = f"the network has no edge {slot_text(source)} -> {slot_text(target)}"
            reason = Reason(task.goal, target[0], "no_edge", message, lacks=target)
        case GrantFact(atom) | SetProperty(atom=atom) | SetFactor(atom=atom):
            unit = task.domain.predicate_by_name[atom.predicate].unit
            message = f"{atom.text} does not hold"
            reason = Reason(task.goal, "", "not_feasible", message, atom, task.margin(atom), unit)
        case JoinClass(_, object_class) | IdealToken(object_class):
            reason = _short_class(task, object_class)
        case CopyToken(like):
            reason = _short_class(task, next(each for each in like.classes if each in task.domain.classes))
    return replace(reason, message=f"{reason.message}; the task would have a plan with {change.what}")


def _short_class(task: Task, object_class: type[ObjectClass]) -> Reason:
    have = len(task.values_of(object_class))
    message = f"the task has {have} {'token' if have == 1 else 'tokens'} of class {object_class.name}"
    return Reason(task.goal, "", "too_few_tokens" if have else "no_token", message, lacks=object_class)
