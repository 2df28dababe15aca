"""Why a task has no plan, read from its declarations: each reason is true and can be checked by hand.

For every goal atom that cannot be reached, the blocks that could bring it about are examined, and in turn the blocks
that could bring about what those wait for. A block is of no use where a slot can be filled by no token, where tokens
are short, or where its feasibility facts hold for no choice of tokens; then the margin of the best choice is told.
"""

import math
import time
from dataclasses import dataclass, replace

from hybrid_tamp.feasibility.backward_search import Backwards
from hybrid_tamp.feasibility.bindings import TooMany
from hybrid_tamp.feasibility.reasons import TOGETHER, Reason, merged
from hybrid_tamp.feasibility.relevance import relevant_part
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.explain.candidates import points_to
from hybrid_tamp.questions.explain.minimal_reasons import needed, together
from hybrid_tamp.questions.explain.repairs import Repairs, Suggestion, but_for, repairs
from hybrid_tamp.questions.explain.trial_plans import Trying

__all__ = ["Explanation", "Reason", "explain", "explain_wholly"]

MOST_EXPLAINED = 5
"""Of a goal with a choice, why so many alternatives cannot be reached is told."""


@dataclass(frozen=True)
class Explanation:
    """Why a task has no plan, and what would give it one.

    Attributes:
        reasons: the reasons; those first that a suggestion takes away.
        suggestions: single changes with which there is a plan; each was planned.
        complete: whether every single change was looked at, or as many were found as were asked for.
        together: changes that give a plan together, where no single one was found.
    """

    reasons: tuple[Reason, ...]
    suggestions: tuple[Suggestion, ...]
    complete: bool
    together: tuple[str, ...] = ()


def explain_wholly(task: Task, seconds: float, most: int) -> Explanation:
    """Return why a task that is proven to have no plan has none, and single changes with which it has one.

    What only a change shows is a reason, too: but for this, there would be a plan.

    Args:
        task: the task.
        seconds: how long changes are looked for.
        most: how many changes are enough.

    Returns:
        The suggestions, and the smallest set of reasons that was found in the time (see `smallest`).
    """
    part = relevant_part(task)
    reasons = explain_alternatives(part, proven=True)
    with Trying(time.monotonic() + seconds) as trying:
        found = _repairs(part, reasons, trying, most)
        if part is not task and not found.suggestions:
            # A change may make use of what nobody needs as things are: an edge through another block.
            found = _repairs(task, reasons, trying, most)
        elif part is not task:
            found = replace(found, complete=len(found.suggestions) >= most)
        told = [*reasons, *but_for(task, reasons, found.suggestions)]
        pointed = [r for r in told if any(points_to(task, r, each.change) for each in found.suggestions)]
        others = [r for r in told if r not in pointed and not (pointed and r.kind == TOGETHER)]
        if found.suggestions:
            return Explanation((*pointed, *needed(part, others, trying)), found.suggestions, found.complete)
        kept, changes = together(part, others, trying)
        return Explanation(tuple(kept), (), found.complete, tuple(each.what for each in changes))


def explain(task: Task, proven: bool = False) -> list[Reason]:
    """Return reasons why the goal cannot be reached; an empty list if none is visible in the declarations.

    Args:
        task: the task.
        proven: whether it is proven that there is no plan; then it is also said if no single fact excludes one.
    """
    search = Backwards(task)
    open_atoms = [atom for atom in task.goal if not search.holds(atom)]
    # First what is told by the last blocks alone: looking further back is bounded.
    direct = {atom: search.direct(atom) for atom in open_atoms}
    reasons = {atom: told or _reasons(search, atom) for atom, told in direct.items()}
    found = [reason for atom in open_atoms for reason in merged(str(atom), reasons[atom])]
    return found if found or not proven else [_hidden(open_atoms)]


def explain_alternatives(task: Task, proven: bool = False) -> list[Reason]:
    """Return why the goal cannot be reached; of a goal with a choice, why none of the nearest alternatives can."""
    return list(dict.fromkeys(r for each in task.alternatives()[:MOST_EXPLAINED] for r in explain(each, proven)))


def _repairs(task: Task, reasons: list[Reason], trying: Trying, most: int) -> Repairs:
    """Look for changes with which one of the nearest alternatives can be reached."""
    found, complete = list[Suggestion](), True
    for each in task.alternatives()[:MOST_EXPLAINED]:
        more = repairs(each, reasons, trying, most - len(found))
        found += more.suggestions
        complete = complete and more.complete
        if len(found) >= most:
            break
    return Repairs(tuple(found), complete)


def _hidden(atoms: list[Atom]) -> Reason:
    goal = " and ".join(map(str, atoms))
    if len(atoms) > 1:
        message = "each goal alone is possible as far as the feasibility facts tell; together they are not"
    else:
        message = "no single feasibility fact excludes it; what its blocks need cannot be brought about together"
    return Reason(goal, "", TOGETHER, message)


def _reasons(search: Backwards, goal: Atom) -> list[Reason]:
    try:
        return [] if search.explore(goal) else _Walk(search).reasons(goal)
    except TooMany:
        return []


class _Walk:
    """From an atom that cannot be reached to what is at the bottom of it."""

    def __init__(self, search: Backwards) -> None:
        self._search = search
        self._reached = search.reached()
        self._known: dict[Atom, list[Reason]] = {}

    def reasons(self, atom: Atom) -> list[Reason]:
        """Return why blocks that bring it about are of no use, and what keeps the nearest of the others."""
        if atom not in self._known:
            # A way that comes round in a circle has no reason of its own.
            self._known[atom] = []
            ways = self._search.ways[atom]
            at_hand = [] if ways.reasons else self._search.at_hand(atom, self._reached)
            missing = {next(wait for wait in waits if wait not in self._reached): None for waits in ways.waits}
            behind = [found for wait in missing if (found := self.reasons(wait))]
            nearest = max(behind, key=self._nearness, default=[])
            self._known[atom] = [*ways.reasons, *(at_hand or nearest)]
        return self._known[atom]

    def _nearness(self, reasons: list[Reason]) -> float:
        """Return how little is missing by the worst of the reasons, in units of violation."""
        return min(self._violation(reason) for reason in reasons)

    def _violation(self, reason: Reason) -> float:
        if reason.margin is None:
            return -math.inf
        name = reason.atom.removeprefix("not ").partition("(")[0]
        return reason.margin / self._search.task.domain.predicate_by_name[name].scale
