"""Why a task has no plan, read from its declarations: each reason is true and can be checked by hand.

For every goal atom that cannot be reached, the search examines the blocks that could bring it about, and in turn the
blocks that could bring about the atoms for which those wait. A block is useless if no token can fill one of its slots,
if there are too few tokens, or if its feasibility facts hold for no choice of tokens; the reason then names the margin
of the best choice.
"""

import math
import time
from dataclasses import replace

from hybrid_tamp.feasibility.backward_search import BackwardSearch
from hybrid_tamp.feasibility.bindings import TooMany
from hybrid_tamp.feasibility.mode_names import merge_reasons
from hybrid_tamp.feasibility.relevance import keep_relevant
from hybrid_tamp.model.explanation import Explanation, Reason, Suggestion
from hybrid_tamp.model.outcome import CLASS_UNKNOWN, MESSAGES, NOT_REFINED, Exclusion, PlanOutcome
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.explain.candidates import points_to
from hybrid_tamp.questions.explain.minimal_reasons import keep_necessary, remove_together
from hybrid_tamp.questions.explain.repairs import Repairs, find_counterfactual_reasons, find_repairs
from hybrid_tamp.questions.explain.trial_plans import TrialPlanner

MOST_EXPLAINED = 5
"""Largest number of alternatives of a goal with a choice that are explained."""


def explain_failure(outcome: PlanOutcome, seconds: float = 0.0, most: int = 1) -> Explanation:
    """Explain why planning a task gave no plan.

    Args:
        outcome: the outcome of planning, without a plan. If its failure has a detail, there is no search for reasons.
        seconds: time to search for single changes if it is proven that there is no plan [s].
        most: the number of changes that is enough.
    """
    task, failure = outcome.task, outcome.failure
    assert failure is not None, "it has no plan"
    if failure.kind == CLASS_UNKNOWN:
        return Explanation(failure.kind, failure.message, _unknown_classes(task))
    if failure.kind == NOT_REFINED:
        return Explanation(failure.kind, failure.message, tuple(_excluded(task, each) for each in outcome.excluded))
    if failure.detail:
        return Explanation(failure.kind, failure.message)
    if failure.kind == "unsolvable" and seconds:
        return explain_wholly(task, seconds, most)
    reasons = explain_alternatives(task, failure.kind == "unsolvable")
    return Explanation(failure.kind, failure.message, tuple(reasons))


def _excluded(task: Task, exclusion: Exclusion) -> Reason:
    """Return the exclusion of a binding as a reason."""
    short, block = exclusion.shortfall, exclusion.instance.block
    return Reason(task.goal, block, "forward models", exclusion.text, short.atom, short.margin, short.unit)


def explain_wholly(task: Task, seconds: float, most: int) -> Explanation:
    """Explain why a task that is proven to have no plan has none, and find single changes with which it has one.

    A change with which there is a plan also proves a reason: without the change there is no plan.

    Args:
        task: the task.
        seconds: time to search for changes [s].
        most: the number of changes that is enough.

    Returns:
        The suggestions, and the smallest set of reasons that was found in the time (see `minimal_reasons`).
    """
    part = keep_relevant(task)
    reasons = explain_alternatives(part, proven=True)
    with TrialPlanner(time.monotonic() + seconds) as trials:
        found = _find_repairs(part, reasons, trials, most)
        if part is not task and not found.suggestions:
            # A change may make another block relevant, for example by an edge through it.
            found = _find_repairs(task, reasons, trials, most)
        elif part is not task:
            found = replace(found, complete=len(found.suggestions) >= most)
        true = [*reasons, *find_counterfactual_reasons(task, reasons, found.suggestions)]
        pointed = [r for r in true if any(points_to(r, each.change) for each in found.suggestions)]
        others = [r for r in true if r not in pointed and not (pointed and r.kind == "together")]
        whole = Explanation("unsolvable", MESSAGES["unsolvable"], (), found.suggestions, found.complete)
        if found.suggestions:
            return replace(whole, reasons=(*pointed, *keep_necessary(part, others, trials)))
        kept, changes = remove_together(part, others, trials)
        return replace(whole, reasons=tuple(kept), together=tuple(changes))


def explain(task: Task, proven: bool = False) -> list[Reason]:
    """Return reasons why the goal cannot be reached; an empty list if none is visible in the declarations.

    Args:
        task: the task.
        proven: whether it is proven that there is no plan; then the answer is never empty.
    """
    search = BackwardSearch(task)
    open_atoms = [atom for atom in task.goal if not search.holds(atom)]
    # First the blocks that bring the goal about, because the search further back is bounded.
    direct = {atom: search.explain_directly(atom) for atom in open_atoms}
    reasons = {atom: told or _reasons(search, atom) for atom, told in direct.items()}
    found = [reason for atom in open_atoms for reason in merge_reasons(atom, reasons[atom])]
    return found if found or not proven else [_hidden(open_atoms)]


def explain_alternatives(task: Task, proven: bool = False) -> list[Reason]:
    """Return why the goal cannot be reached; for a goal with a choice, why its nearest alternatives cannot."""
    return list(dict.fromkeys(r for each in task.alternatives()[:MOST_EXPLAINED] for r in explain(each, proven)))


def _find_repairs(task: Task, reasons: list[Reason], trials: TrialPlanner, most: int) -> Repairs:
    """Search for changes with which one of the nearest alternatives can be reached."""
    found, complete = list[Suggestion](), True
    for each in task.alternatives()[:MOST_EXPLAINED]:
        if len(found) < most:
            more = find_repairs(each, reasons, trials, most - len(found))
            found += more.suggestions
            complete = complete and more.complete
    return Repairs(tuple(found), complete)


def _unknown_classes(task: Task) -> tuple[Reason, ...]:
    """Return a reason for every goal atom that needs a class of which its token may or may not be a member."""
    reasons = []
    for atom, token, object_class in task.unsettled:
        message = f"it is unknown whether {token.name} is a member of {object_class.name}"
        probe = (str(task.source or task.name), token.name)
        reasons.append(Reason((atom,), "", "class_unknown", message, lacks=object_class, probe=probe))
    return tuple(reasons)


def _hidden(atoms: list[Atom]) -> Reason:
    if len(atoms) > 1:
        message = "each goal alone is possible as far as the feasibility facts tell; together they are not"
    else:
        message = "no single feasibility fact excludes it; what its blocks need cannot be brought about together"
    return Reason(tuple(atoms), "", "together", message)


def _reasons(search: BackwardSearch, goal: Atom) -> list[Reason]:
    try:
        return [] if search.explore(goal) else _Walk(search).reasons(goal)
    except TooMany:
        return []


class _Walk:
    """Collects the reasons why an atom cannot be reached, backwards from it."""

    def __init__(self, search: BackwardSearch) -> None:
        self._search = search
        self._reached = search.find_reached()
        self._known: dict[Atom, list[Reason]] = {}

    def reasons(self, atom: Atom) -> list[Reason]:
        """Return why blocks that bring an atom about are useless, and what prevents the nearest other block."""
        if atom not in self._known:
            # A way that leads back to itself has no reason of its own.
            self._known[atom] = []
            ways = self._search.ways[atom]
            at_hand = [] if ways.reasons else self._search.explain_infeasible(atom, self._reached)
            missing = {next(wait for wait in waits if wait not in self._reached): None for waits in ways.waits}
            behind = [found for wait in missing if (found := self.reasons(wait))]
            nearest = max(behind, key=lambda reasons: min(map(self._violation, reasons)), default=[])
            self._known[atom] = [*ways.reasons, *(at_hand or nearest)]
        return self._known[atom]

    def _violation(self, reason: Reason) -> float:
        """Return the margin of a reason in scales of its predicate; minus infinity if it has none."""
        if reason.margin is None or reason.atom is None:
            return -math.inf
        return reason.margin / self._search.task.domain.predicate_by_name[reason.atom.predicate].scale
