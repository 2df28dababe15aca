"""Which single change of a task gives it a plan, found by planning the changed task.

The delete relaxation of a changed task takes some hundredths of a second and can prove that the change is useless. The
planner tries the other changes, and its plans must obey the law. If the task has no plan only because of what blocks
delete, the relaxation proves nothing. Then the planner gets many edges or facts at once: if all of them together are
useless, each one is.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from hybrid_tamp.model.affordance import ObjectClass
from hybrid_tamp.model.change import AddEdge, Change, CopyToken, GrantFact, IdealToken, JoinClass, SetProperty
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
"""Largest number of suggested changes of one kind: a third hand is no news."""


@dataclass(frozen=True)
class Repairs:
    """The result of a search for single changes.

    Attributes:
        suggestions: changes that give the task a plan, in the order in which they were found.
        complete: whether every single change was examined, or the wanted number of changes was found.
    """

    suggestions: tuple[Suggestion, ...]
    complete: bool


def find_repairs(task: Task, reasons: Sequence[Reason], trials: TrialPlanner, most: int) -> Repairs:
    """Search for single changes that give a task a plan.

    Args:
        task: a task that has no plan.
        reasons: known reasons why it has none; the changes to which they point are tried first.
        trials: plans changed tasks; when its time is over, only the current search is finished.
        most: the number of changes that is enough.
    """
    found: list[Suggestion] = []
    kinds, copied = Counter[str](), set[str]()
    for change in _Sieve(task, reasons, trials).promising(propose_changes(task, reasons)):
        if trials.over:
            return Repairs(tuple(found), complete=False)
        # Copies of one token at several places count once.
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
    """Separates changes that may be useful from those that are proven to be useless."""

    def __init__(self, task: Task, reasons: Iterable[Reason], trials: TrialPlanner) -> None:
        self._task = task
        self._known = StaticFacts(task)
        self._trials = trials
        # Reasons of other kinds come from the delete relaxation.
        self._relaxed_unsolvable = any(reason.kind != "together" for reason in reasons) or not self._possible([])

    def promising(self, changes: Iterable[Change]) -> Iterator[Change | None]:
        """Yield the changes that may be useful, and None after other tests so that the caller can check the time."""
        for kind, group in groupby(changes, key=lambda change: change.kind):
            if kind not in ("edge", "fact"):
                yield from (change if self._possible([change]) else None for change in group)
            elif self._relaxed_unsolvable:
                yield from self._split(list(group), self._possible)
            else:
                # Planning takes longer: the first changes are tried alone, later ones in larger and larger groups.
                rest, size = list(group), 1
                while rest:
                    yield from self._split(rest[:size], self._may_be_planned)
                    rest, size = rest[size:], 2 * size

    def _split(self, group: list[Change], may_help: Callable[[list[Change]], bool]) -> Iterator[Change | None]:
        """Yield the useful ones among many changes: if all together are useless, each one is."""
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
        compilation = compile_task(apply_together(self._task, group))
        if not group or isinstance(group[0], AddEdge):
            # Facts take most of the time, and an edge changes none.
            compilation = replace(compilation, feasible=self._known)
        return may_be_solvable(compilation.problem)

    def _may_be_planned(self, group: list[Change]) -> bool:
        # The caller plans single changes.
        return len(group) == 1 or not self._trials.proves_unsolvable(apply_together(self._task, group))


def find_counterfactual_reasons(
    task: Task, reasons: Iterable[Reason], suggestions: Iterable[Suggestion]
) -> list[Reason]:
    """Return a reason for each suggestion to which no other reason points."""
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
        case GrantFact(atom) | SetProperty(atom=atom):
            unit = task.domain.predicate_by_name[atom.predicate].unit
            message = f"{atom.text} does not hold"
            reason = Reason(task.goal, "", "not_feasible", message, atom, task.margin(atom), unit)
        case JoinClass(_, object_class) | IdealToken(object_class):
            reason = _short_class(task, object_class)
        case CopyToken(like):
            reason = _short_class(task, next(each for each in like.classes if each in task.domain.classes))
    return replace(reason, message=f"{reason.message}; with {change.what} there would be a plan")


def _short_class(task: Task, object_class: type[ObjectClass]) -> Reason:
    have = len(task.values_of(object_class))
    message = f"the task has {have} of class {object_class.name}"
    return Reason(task.goal, "", "too_few_tokens" if have else "no_token", message, lacks=object_class)
