"""Planning on a tailored network, which is first reduced and then widened until a plan is found (paper, Sec. II-C)."""

import logging
import time
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.expectation import Expectations
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.outcome import CLASS_UNKNOWN, PlannerFigures, PlanningFailure, PlanOutcome
from hybrid_tamp.model.planned_network import AddedToken, PlannedNetwork
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.reduction import Reduction
from hybrid_tamp.planning.widening import Widening, find_unreachable
from hybrid_tamp.symbolic.find_plan import find_plan
from hybrid_tamp.symbolic.strategies.search import Planner, SearchResult

_LOG = logging.getLogger(__name__)

_WITHOUT = {
    "unsolvable": "the planner has proven that no plan exists without this object in the network",
    "not_found": "the planner found no plan without this object in the network",
    "plan_refused": "without this object in the network, the plan that was found breaks the law of assignment",
}


def plan_task(
    task: Task, planner: Planner, deadline: Deadline | None = None, expectations: Expectations | None = None
) -> PlanOutcome:
    """Plan a task on its reduced network, and add other objects to the network until a plan is found.

    The outcome is 'unsolvable' only if the network contains every token and block that a plan could use. If a limit
    ends the planning, the outcome is a failure that may contain the best plan so far.

    Args:
        task: the task to plan.
        planner: a running planner process.
        deadline: deadline of the command. By default, the time limit of the task counts from now.
        expectations: expectations of instances, which the plans of several tasks may share.

    Raises:
        InputError: if the planning engine is unknown or not installed, or if the goal cannot be compiled.
    """
    if task.unsettled:
        figures, network = PlannerFigures(task.planner, 0.0), PlannedNetwork.of(task, task)
        return PlanOutcome(task, figures, network, failure=PlanningFailure(CLASS_UNKNOWN))
    tailored = _TailoredNetwork(task, deadline or Deadline.after(task.limits.time))
    try:
        while True:
            tailored.reach_goal()
            relax = tailored.can_widen
            reduced = tailored.reduction.task
            found = find_plan(reduced, planner, tailored.deadline, relax=relax, expectations=expectations)
            planned = _extend(tailored, found)
            if not relax or planned.status not in _WITHOUT:
                break
            tailored.widen(_WITHOUT[planned.status])
    except LimitReached as limit:
        figures = PlannerFigures(task.planner, tailored.elapsed)
        return PlanOutcome(task, figures, tailored.network, failure=PlanningFailure.of(limit))
    outcome = _outcome(tailored, planned)
    _log_outcome(outcome)
    return outcome


def _log_outcome(outcome: PlanOutcome) -> None:
    found = "no plan" if outcome.plan is None else f"{len(outcome.plan.actions)} actions, {outcome.makespan:.2f} s"
    figures = outcome.planner
    stages = ", ".join(f"{name} {seconds:.2f} s" for name, seconds in figures.stages.items())
    _LOG.info("%s planned %s in %.2f s: %s (%s)", figures.name, outcome.task.name, figures.seconds, found, stages)


def tailor_network(task: Task) -> PlannedNetwork:
    """Return the network with which planning begins.

    The network is reduced, and contains the objects without which no block achieves an atom of the goal. If the planner
    finds no plan, `plan_task` adds more objects.
    """
    if task.unsettled:
        return PlannedNetwork.of(task, task)
    tailored = _TailoredNetwork(task, Deadline.after(task.limits.time))
    tailored.reach_goal()
    return tailored.network


class _TailoredNetwork:
    """The current tailored network of a task, with the planning time so far.

    Attributes:
        task: the whole task.
        deadline: deadline of the command.
        reduction: the task reduced to the current network.
        added: objects added to the network so far, in order.
        stages: maps each stage of planning to its total time in seconds.
    """

    def __init__(self, task: Task, deadline: Deadline) -> None:
        self.task = task
        self.deadline = deadline
        self._began = time.monotonic()
        self._widening = Widening(task)
        self._step = 1
        self.reduction: Reduction = self._widening.reducer.reduce()
        self.added: list[AddedToken] = []
        self.stages: defaultdict[str, float] = defaultdict(float)

    @property
    def elapsed(self) -> float:
        """Time since planning began, in seconds."""
        return time.monotonic() - self._began

    @property
    def can_widen(self) -> bool:
        """Whether objects remain that can be added to the network."""
        return bool(self._widening.find_outside(self.reduction))

    @property
    def unreachable(self) -> str:
        """Message about goal atoms that no block of the network achieves. Empty if blocks achieve all atoms."""
        atoms = " and ".join(atom.text for atom in find_unreachable(self.reduction.task))
        return f"without this object in the network, no block achieves {atoms}" if atoms else ""

    @property
    def network(self) -> PlannedNetwork:
        """Description of the current network."""
        return PlannedNetwork.of(self.task, self.reduction.task, self.added)

    def reach_goal(self) -> None:
        """Add objects to the network until its blocks achieve every goal atom, or until no objects remain.

        Raises:
            LimitReached: if the deadline passes.
        """
        while self.can_widen:
            self.deadline.check()
            if not (why := self.unreachable):
                return
            self.widen(why)

    def widen(self, why: str) -> None:
        """Add the next objects to the network for the reason ``why``.

        The number of objects doubles with every call, unless a single object may suffice to reach the goal.
        """
        for name in self._widening.choose_next(self.reduction, self._step):
            blocks = self._widening.find_newly_fillable(self.reduction, name)
            classes = tuple(c.name for c in self.task.token_by_name[name].classes if c is not TOKEN)
            self.added.append(AddedToken(name, classes, blocks, why))
            self.reduction = self._widening.reducer.reduce((*self.reduction.brought, name))
            _LOG.info("added %s to the network: %s", name, why)
        self._step *= 2

    def count(self, stages: Mapping[str, float]) -> None:
        """Add times in seconds to the totals of the stages."""
        for name, seconds in stages.items():
            self.stages[name] += seconds


def _extend(tailored: _TailoredNetwork, planned: SearchResult) -> SearchResult:
    """Extend a plan on the reduced network to a checked plan of the whole task."""
    tailored.count(planned.stages)
    task, reduction = tailored.task, tailored.reduction
    goal = planned.task.goal if planned.task else task.goal
    whole = task if goal == task.goal else task.replaced(goal=goal)
    planned = replace(planned, task=whole)
    if planned.plan is None or not reduction.tokens_left_out:
        return planned
    began = time.monotonic()
    plan = reduction.restore(planned.plan)
    violations = check_law(whole, plan)
    tailored.count({"law": time.monotonic() - began})
    if not violations:
        return replace(planned, plan=plan)
    refusal = "; ".join(each.text for each in violations)
    _LOG.warning("the plan on the reduced network is not a lawful plan of the whole task: %s", refusal)
    return replace(planned, plan=None, refusal=refusal)


def _outcome(tailored: _TailoredNetwork, planned: SearchResult) -> PlanOutcome:
    stages, engine = dict(tailored.stages), planned.answer.engine
    figures = PlannerFigures(engine, tailored.elapsed, planned.way, stages, planned.fewest)
    if tailored.can_widen:
        figures = figures.unproven  # Another object may allow a plan with fewer actions.
    outcome = PlanOutcome(tailored.task, figures, tailored.network)
    if planned.plan is not None:
        stopped = None if planned.stopped is None else PlanningFailure.of(planned.stopped)
        return replace(outcome, plan=planned.plan, chosen=planned.task, failure=stopped)
    detail = planned.refusal or ("" if planned.status == "unsolvable" else planned.answer.message)
    return replace(outcome, failure=PlanningFailure(planned.status, detail))
