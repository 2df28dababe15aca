"""Planning on a network tailored to the task: reduced first, widened where that has no plan (paper, Sec. II-C)."""

import logging
import time
from collections import defaultdict
from dataclasses import replace

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.reduction import Reduction
from hybrid_tamp.planning.widening import Brought, Widening, out_of_reach
from hybrid_tamp.symbolic.find_plan import find_plan
from hybrid_tamp.symbolic.strategies.search import Planner, SearchResult

_LOG = logging.getLogger(__name__)

UNREACHABLE = "in the network without it no block brings about"
"""Why an object is brought in without planning."""
_WITHOUT = {
    "unsolvable": "the network without it has no plan; the planner has proven that",
    "not_found": "the planner found no plan in the network without it",
    "plan_refused": "the planner's plan in the network without it was refused",
    "limit": "the planner found no plan in the network without it in half of the time that was left",
}
_TOO_LONG = "limit"


class Tailoring:
    """Planning of one task.

    Attributes:
        task: the task.
        reduction: the network that is planned on, or was last.
        brought: the objects that were brought in so far, in their order.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self._began = time.monotonic()
        self._widening = Widening(task)
        self.reduction: Reduction = self._widening.reduced()
        self.brought: list[Brought] = []
        self._stages: defaultdict[str, float] = defaultdict(float)

    def planned(self, planner: Planner) -> SearchResult:
        """Return a lawful plan of the whole task, or why there is none.

        'Unsolvable' is said only where nothing was left out that could be in a plan.

        Args:
            planner: a running planner process.

        Raises:
            InputError: the engine is not installed or not known, or the goal cannot be compiled.
            LimitReached: all attempts together ran into the time limit, or one into the memory limit.
        """
        most = 1
        while self._widening.outside(self.reduction, self._names):
            why = self._unreachable()
            planned = None if why else self._attempt(planner, share=0.5)
            if planned is not None and planned.status not in _WITHOUT:
                return self._told(planned)
            step = self._widening.step(self.reduction, self._names, most)
            self._bring_in(step, why or _WITHOUT[planned.status if planned else _TOO_LONG])
            most *= 2
        last = self._attempt(planner)
        assert last is not None, "with all the time that is left, it ends or raises"
        return self._told(last)

    @property
    def _names(self) -> list[str]:
        return [each.token for each in self.brought]

    def _unreachable(self) -> str:
        """Return which goal atoms no block of the reduced network brings about."""
        atoms = out_of_reach(self.reduction.task)
        return f"{UNREACHABLE} {' and '.join(map(str, atoms))}" if atoms else ""

    def _bring_in(self, names: list[str], why: str) -> None:
        for name in names:
            blocks = self._widening.fillable(self.reduction, self._names, name)
            classes = tuple(c.name for c in self.task.token_by_name[name].classes if c is not TOKEN)
            self.brought.append(Brought(name, classes, blocks, why))
            self.reduction = self._widening.reduced(self._names)
            _LOG.info("%s is brought in: %s", name, why)

    def _attempt(self, planner: Planner, share: float = 1.0) -> SearchResult | None:
        """Plan on the reduced network within a share of the time that is left, or return None after that.

        Raises:
            LimitReached: there was no time left, or the memory did not do.
        """
        left = share * (self.task.limits.time - self._elapsed)
        if left <= 0:
            raise self._out_of_time()
        try:
            limits = replace(self.task.limits, time=left)
            planned = find_plan(self.reduction.task.replaced(limits=limits), planner)
        except LimitReached as reached:
            if reached.limit != "time":
                raise
            if share < 1:
                return None
            raise self._out_of_time() from reached
        for stage, seconds in planned.stages.items():
            self._stages[stage] += seconds
        return self._restored(planned)

    def _out_of_time(self) -> LimitReached:
        together = ", all attempts together" if self.brought else ""
        message = f"the planner reached its time limit of {self.task.limits.time:g} s{together}"
        return LimitReached(message, limit="time")

    def _restored(self, planned: SearchResult) -> SearchResult:
        """Return what came of planning, with a plan of the whole task: that it is one is checked."""
        goal = planned.task.goal if planned.task else self.task.goal
        whole = self.task if goal == self.task.goal else self.task.replaced(goal=goal)
        planned = replace(planned, task=whole)
        if planned.plan is None or not self.reduction.tokens_left_out:
            return planned
        began = time.monotonic()
        plan = self.reduction.restored(planned.plan)
        violations = check_law(whole, plan)
        self._stages["law"] += time.monotonic() - began
        if not violations:
            return replace(planned, plan=plan)
        refusal = "; ".join(map(str, violations))
        _LOG.warning("the plan of the reduced network is none of the whole task: %s", refusal)
        return replace(planned, plan=None, refusal=refusal)

    @property
    def _elapsed(self) -> float:
        return time.monotonic() - self._began

    def _told(self, planned: SearchResult) -> SearchResult:
        """Return what came of planning, with the time of all attempts together."""
        answer = replace(planned.answer, seconds=self._elapsed)
        return replace(planned, answer=answer, stages=dict(self._stages))
