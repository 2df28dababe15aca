"""Reasons why a task has no plan, derived from its declarations. Each reason is true and can be checked by hand.

A backward search starts at every goal atom that cannot be reached. The search examines the blocks that could achieve
the atom, then the blocks that could achieve the preconditions of these blocks. A block cannot run if:

- no token can fill one of its slots,
- the task has too few tokens for its slots, or
- its feasibility facts fail for every choice of tokens. The reason then states the margin of the best choice.

The blocks may also wait for each other: each block that could achieve an atom needs an atom that only these blocks
achieve. The reason is then the needed atom (see `unreachable`).
"""

import math
from dataclasses import replace

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.feasibility.backward_search import BackwardSearch
from hybrid_tamp.feasibility.bindings import TooMany
from hybrid_tamp.feasibility.mode_names import merge_reasons
from hybrid_tamp.feasibility.relevance import keep_relevant
from hybrid_tamp.model.deadline import NEVER, Deadline
from hybrid_tamp.model.explanation import Explanation, Reason, Suggestion
from hybrid_tamp.model.outcome import (
    BLOCKED,
    CLASS_UNKNOWN,
    MESSAGES,
    NOT_REFINED,
    SAFETY,
    Exclusion,
    PlanningFailure,
    PlanOutcome,
)
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.explain.candidates import points_to
from hybrid_tamp.questions.explain.minimal_reasons import keep_necessary, plan_atoms_alone, remove_together
from hybrid_tamp.questions.explain.repairs import Repairs, find_counterfactual_reasons, find_repairs
from hybrid_tamp.questions.explain.trial_plans import TrialPlanner
from hybrid_tamp.questions.explain.unreachable import explain_cycle, name_atom

MOST_EXPLAINED = 5
"""Maximum number of alternatives to explain if the goal allows a choice. The nearest alternatives come first."""


def explain_outcome(outcome: PlanOutcome, trials: int, most: int, deadline: Deadline) -> PlanOutcome:
    """Return a failed outcome of planning with its explanation (see `explain_failure`).

    If a time or memory limit ends the search for changes, the failure of the outcome is replaced by this limit. The
    explanation then has the reasons that are known so far.
    """
    assert outcome.failure is not None, "the outcome must be a failure"
    explanation = explain_failure(outcome, trials, most, deadline)
    outcome, stopped = replace(outcome, explanation=explanation), explanation.stopped
    if stopped is None:
        return outcome
    detail = f"{stopped}. The limit ended the search for changes that would help. {explanation.message}"
    return replace(outcome, failure=PlanningFailure(stopped.limit, detail))


def explain_failure(outcome: PlanOutcome, trials: int = 0, most: int = 1, deadline: Deadline = NEVER) -> Explanation:
    """Explain why planning found no plan.

    Args:
        outcome: the outcome of planning, which must be a failure. A failure with a detail text gets no other reasons.
        trials: largest number of changed tasks to plan. Changes are tried only if the task is proven to have no plan.
        most: number of suggested changes after which the search stops.
        deadline: deadline of the command.
    """
    task, failure = outcome.task, outcome.failure
    assert failure is not None, "the outcome must be a failure"
    if failure.kind == CLASS_UNKNOWN:
        return Explanation(failure.kind, failure.message, _unknown_classes(task))
    if failure.kind in (NOT_REFINED, BLOCKED):
        return Explanation(failure.kind, failure.message, tuple(_excluded(task, each) for each in outcome.excluded))
    if failure.detail and failure.kind != SAFETY:
        return Explanation(failure.kind, failure.message)
    proven = failure.kind in ("unsolvable", SAFETY)  # With its safety factors, the task has no plan.
    if proven and trials:
        found = explain_wholly(task, trials, most, deadline)
        return replace(found, kind=failure.kind, message=failure.message)
    reasons = explain_alternatives(task, proven)
    return Explanation(failure.kind, failure.message, tuple(reasons))


def _excluded(task: Task, exclusion: Exclusion) -> Reason:
    short, block = exclusion.shortfall, exclusion.instance.block
    return Reason(task.goal, block, "forward models", exclusion.text, short.atom, short.margin, short.unit)


def explain_wholly(task: Task, trials: int, most: int, deadline: Deadline = NEVER) -> Explanation:
    """Explain why an unsolvable task has no plan, and suggest single changes that make it solvable.

    Each suggested change also yields a reason, because the task has no plan without the change.

    Args:
        task: a task that is proven to have no plan.
        trials: largest number of changed tasks to plan.
        most: number of suggested changes after which the search stops.
        deadline: deadline of the command.

    Returns:
        The suggestions, and the smallest set of reasons found with this number of trials (see `minimal_reasons`). If a
        time or memory limit ends the search, the explanation has all reasons and no suggestions.
    """
    part = keep_relevant(task)
    reasons = explain_alternatives(part, proven=True)
    try:
        with TrialPlanner(trials, deadline) as planner:
            return _try_changes(task, part, reasons, planner, most)
    except LimitReached as limit:
        return Explanation("unsolvable", MESSAGES["unsolvable"], tuple(reasons), stopped=limit)


def _try_changes(task: Task, part: Task, reasons: list[Reason], trials: TrialPlanner, most: int) -> Explanation:
    """Return the explanation of a task, with changes that make the task or its relevant part solvable.

    Raises:
        LimitReached: a time or memory limit is reached.
    """
    found = _find_repairs(part, reasons, trials, most)
    if part is not task and not found.suggestions:
        # A change may make another block relevant, for example by a new edge to the block.
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
    return replace(whole, reasons=tuple(plan_atoms_alone(part, kept, trials)), together=tuple(changes))


def explain(task: Task, proven: bool = False) -> list[Reason]:
    """Return reasons why the goal cannot be reached.

    If the declarations show no reason, the list is empty. If the task is `proven` to have no plan, the list has a
    general reason instead.
    """
    search = BackwardSearch(task)
    open_atoms = [atom for atom in task.goal if not search.holds(atom)]
    # Blocks that achieve a goal atom directly are examined first, because the search for further blocks is bounded.
    direct = {atom: search.explain_directly(atom) for atom in open_atoms}
    reasons = {atom: told or _reasons(search, atom) for atom, told in direct.items()}
    found = [reason for atom in open_atoms for reason in merge_reasons(atom, reasons[atom])]
    return found if found or not proven else [_hidden(task.goal)]


def explain_alternatives(task: Task, proven: bool = False) -> list[Reason]:
    """Return reasons why the nearest alternatives of the goal cannot be reached."""
    return list(dict.fromkeys(r for each in task.alternatives()[:MOST_EXPLAINED] for r in explain(each, proven)))


def _find_repairs(task: Task, reasons: list[Reason], trials: TrialPlanner, most: int) -> Repairs:
    """Search for changes that make one of the nearest alternatives of the goal reachable."""
    found, complete = list[Suggestion](), True
    for each in task.alternatives()[:MOST_EXPLAINED]:
        if len(found) < most:
            more = find_repairs(each, reasons, trials, most - len(found))
            found += more.suggestions
            complete = complete and more.complete
    return Repairs(tuple(found), complete)


def _unknown_classes(task: Task) -> tuple[Reason, ...]:
    """Return a reason for every goal atom that depends on an unknown class membership of its token."""
    reasons = []
    for atom, token, object_class in task.unsettled:
        message = f"it is unknown whether {token.name} is a member of {object_class.name}"
        probe = (str(task.source or task.name), token.name)
        reasons.append(Reason((atom,), "", "class_unknown", message, lacks=object_class, probe=probe))
    return tuple(reasons)


def _hidden(atoms: tuple[Atom, ...]) -> Reason:
    if len(atoms) > 1:
        message = "the facts allow each goal atom on its own, but no plan achieves all goal atoms together"
    else:
        message = "no fact rules out the goal, but no plan meets all preconditions of the blocks that achieve the goal"
    return Reason(atoms, "", "together", message)


def _reasons(search: BackwardSearch, goal: Atom) -> list[Reason]:
    try:
        return [] if search.explore(goal) else _Walk(search).reasons(goal) or explain_cycle(search, goal)
    except TooMany:
        return []


class _Walk:
    """A backward search that collects the reasons why an atom cannot be reached."""

    def __init__(self, search: BackwardSearch) -> None:
        self._search = search
        self._reached = search.find_reached()
        self._known: dict[Atom, list[Reason]] = {}

    def reasons(self, atom: Atom) -> list[Reason]:
        """Return the reasons why the blocks that achieve an atom cannot run."""
        if atom not in self._known:
            # The empty list ends the recursion if an atom depends on itself.
            self._known[atom] = []
            ways = self._search.ways[atom]
            at_hand = [] if ways.reasons else self._search.explain_infeasible(atom, self._reached)
            missing = {next(wait for wait in waits if wait not in self._reached): None for waits in ways.waits}
            behind = [found for wait in missing if (found := self._named(wait))]
            # If blocks only lack preconditions, the reason is the condition that is closest to being satisfied.
            nearest = max(behind, key=lambda reasons: min(map(self._violation, reasons)), default=[])
            self._known[atom] = [*ways.reasons, *(at_hand or nearest)]
        return self._known[atom]

    def _named(self, atom: Atom) -> list[Reason]:
        """Return the reasons for a precondition. If no block could achieve the atom at all, the atom is the reason."""
        return name_atom(self._search.task, atom, self.reasons(atom))

    def _violation(self, reason: Reason) -> float:
        """Return the margin of a reason as a multiple of the predicate's scale, or minus infinity without a margin."""
        if reason.margin is None or reason.atom is None:
            return -math.inf
        return reason.margin / self._search.task.domain.predicate_by_name[reason.atom.predicate].scale
