"""Which single change of a task gives it a plan, found by planning the changed task.

A change is first looked at without what blocks delete, which takes some hundredths of a second and can only prove that
it is of no use; what remains is put to the planner, and its plan is judged by the law as any other. Where that look
proves nothing, because the task has no plan only by what blocks delete, many edges or facts are put to the planner
together: if all of them are of no use, none is.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from hybrid_tamp.feasibility.reasons import TOGETHER, Reason
from hybrid_tamp.model.facts import StaticFacts
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.changes import Change
from hybrid_tamp.questions.explain.candidates import candidates, parsed, points_to, together
from hybrid_tamp.questions.explain.trial_plans import Trying
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.strategies.relaxation import may_be_solvable

OF_A_KIND = 2
"""So many changes of one kind are suggested: a third hand says nothing new."""


@dataclass(frozen=True)
class Suggestion:
    """A change that gives the task a plan.

    Attributes:
        change: the change.
        length: the number of actions of the plan that was found.
    """

    change: Change
    length: int


@dataclass(frozen=True)
class Repairs:
    """What came of looking for single changes.

    Attributes:
        suggestions: changes that give the task a plan, in the order in which they were found.
        complete: whether every single change was looked at, or as many were found as were asked for.
    """

    suggestions: tuple[Suggestion, ...]
    complete: bool


def repairs(task: Task, reasons: Sequence[Reason], trying: Trying, most: int) -> Repairs:
    """Look for single changes that give a task a plan.

    Args:
        task: a task that has no plan.
        reasons: why it has none, as far as is known: what they point to is tried first.
        trying: plans changed tasks; when its time is over, what was begun is finished.
        most: how many changes are enough.
    """
    found: list[Suggestion] = []
    kinds: Counter[str] = Counter()
    for change in _Sieve(task, reasons, trying).promising(candidates(task, reasons)):
        if trying.over:
            return Repairs(tuple(found), complete=False)
        if change is None or kinds[change.kind] == OF_A_KIND or _is_known(change, found):
            continue
        length = trying.length(change.made())
        if length is not None:
            found.append(Suggestion(change, length))
            kinds[change.kind] += 1
        if len(found) == most:
            break
    return Repairs(tuple(found), complete=True)


def _is_known(change: Change, found: Iterable[Suggestion]) -> bool:
    """Say whether one more token like this is suggested already, at another place."""
    return change.kind == "token" and any(
        each.change.kind == "token" and each.change.key[0] == change.key[0] for each in found
    )


class _Sieve:
    """Tells changes that may be of use from those that are proven to be of none."""

    def __init__(self, task: Task, reasons: Iterable[Reason], trying: Trying) -> None:
        self._task = task
        self._known = StaticFacts(task)
        self._trying = trying
        # Reasons of other kinds are found without deletes, too.
        self._hopeless = any(reason.kind != TOGETHER for reason in reasons) or not self._possible([])

    def promising(self, changes: Iterable[Change]) -> Iterator[Change | None]:
        """Yield the changes that may be of use, and now and then None: looking takes time, too."""
        for kind, group in groupby(changes, key=lambda change: change.kind):
            if kind not in ("edge", "fact"):
                yield from (change if self._possible([change]) else None for change in group)
            elif self._hopeless:
                yield from self._split(list(group), self._possible)
            else:
                # Planning takes longer: the first are tried alone, the later ones more and more together.
                rest, size = list(group), 1
                while rest:
                    yield from self._split(rest[:size], self._may_be_planned)
                    rest, size = rest[size:], 2 * size

    def _split(self, group: list[Change], of_use: Callable[[list[Change]], bool]) -> Iterator[Change | None]:
        """Yield of many changes those that may be of use: where all together are of none, no single one is."""
        if not of_use(group):
            yield None
        elif len(group) == 1:
            yield from group
        else:
            middle = len(group) // 2
            yield None
            yield from self._split(group[:middle], of_use)
            yield from self._split(group[middle:], of_use)

    def _possible(self, group: list[Change]) -> bool:
        compilation = compile_task(together(self._task, group))
        if not group or group[0].kind == "edge":
            # An edge changes no facts, which take the most time.
            compilation = replace(compilation, feasible=self._known)
        return may_be_solvable(compilation.problem)

    def _may_be_planned(self, group: list[Change]) -> bool:
        # One alone is planned by whoever asks for it.
        return len(group) == 1 or not self._trying.excluded(together(self._task, group))


def but_for(task: Task, reasons: Iterable[Reason], suggestions: Iterable[Suggestion]) -> list[Reason]:
    """Return a reason for each suggestion to which no other reason points: but for this, there would be a plan."""
    goal = " and ".join(map(str, task.goal))
    found: list[Reason] = []
    for suggestion in suggestions:
        if not any(points_to(task, reason, suggestion.change) for reason in (*reasons, *found)):
            found.append(_counterfactual(task, goal, suggestion.change))
    return found


def _counterfactual(task: Task, goal: str, change: Change) -> Reason:
    said = f"with {change.what} there would be a plan"
    if change.kind == "edge":
        source, target = change.key
        message = f"the network has no edge {source} -> {target}; {said}"
        return Reason(goal, target.rpartition(".")[0], "no_edge", message, lacks=target)
    if change.kind in ("fact", "property"):
        atom = change.key[-1]
        predicate = task.domain.predicate_by_name[atom.removeprefix("not ").partition("(")[0]]
        message = f"{atom} does not hold; {said}"
        return Reason(goal, "", "not_feasible", message, atom, task.margin(parsed(atom)), predicate.unit)
    lacks = change.key[-1] if change.kind == "class" or len(change.key) == 1 else _own_class(task, change.key[0])
    have = len(task.values_of(task.domain.class_by_name[lacks]))
    kind = "too_few_tokens" if have else "no_token"
    return Reason(goal, "", kind, f"the task has {have} of class {lacks}; {said}", lacks=lacks)


def _own_class(task: Task, token: str) -> str:
    own = [member.name for member in task.token_by_name[token].classes if member.name in task.domain.class_by_name]
    return own[0]
