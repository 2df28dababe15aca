"""The state that all strategies share in a search for a plan, and the result of the search."""

import logging
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.conditions import Violation
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.expectation import Expectations
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import BlockInstance, Fewest, PlannedAction, TaskPlan
from hybrid_tamp.model.task import Limits, Task
from hybrid_tamp.symbolic.decode import NotAPlanError
from hybrid_tamp.symbolic.encoding.problem import Compilation, compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerAnswer
from hybrid_tamp.symbolic.engines.registry import FIRST, SHORTENING
from hybrid_tamp.symbolic.estimates import Estimates
from hybrid_tamp.symbolic.pddl.operators import PlanningProblem
from hybrid_tamp.symbolic.schedule import schedule_actions
from hybrid_tamp.symbolic.whereabouts.predicted import BrokenCondition, find_broken_conditions

_LOG = logging.getLogger(__name__)


class Planner(Protocol):
    """Interface of a planner, which `engines.planner_process.PlannerProcess` implements."""

    def solve(self, problem: PlanningProblem, engine: str, limits: Limits) -> PlannerAnswer:
        """Return the engine's answer to a planning problem."""
        ...


@dataclass(frozen=True)
class Candidate:
    """A scheduled plan, with a description of the strategy that found the plan (`way`)."""

    way: str
    plan: TaskPlan


@dataclass(frozen=True)
class SearchResult:
    """The result of a search for a plan.

    Attributes:
        answer: Answer of the engine. If there is a plan, the answer contains the actions of the plan.
        plan: Plan that obeys the law of assignment, or None.
        refusal: Reason why the engine's plan was refused, or an empty string.
        way: Description of the strategy that found the plan.
        stages: Maps each stage to its duration [s].
        task: Task that was planned. If the goal leaves a choice, this is the chosen alternative.
        stopped: Limit that ended the search before its end, or None. The plan is then the best plan so far.
        fewest: What is known about the number of actions, or None if there is no plan or if the makespan is minimised.
        shorter_refused: Whether a plan with fewer actions was refused, because it fails in its predicted states.
    """

    answer: PlannerAnswer
    plan: TaskPlan | None
    refusal: str = ""
    way: str = ""
    stages: Mapping[str, float] = field(default_factory=dict)
    task: Task | None = None
    stopped: LimitReached | None = None
    fewest: Fewest | None = None
    shorter_refused: bool = False

    @property
    def status(self) -> str:
        """Status of the result: ``solved``, ``unsolvable``, ``not_found``, ``planner_crashed`` or ``plan_refused``."""
        if self.plan is not None:
            return "solved"
        if self.refusal:
            return "plan_refused"
        return {"crashed": "planner_crashed", "refused": "plan_refused"}.get(self.answer.status, self.answer.status)

    @property
    def cost(self) -> float:
        """Makespan of the plan [s] if it is minimised, else the number of actions. Infinite if there is no plan."""
        if self.plan is None or self.task is None:
            return float("inf")
        return self.plan.makespan if self.task.objective == "makespan" else float(len(self.plan.actions))


class Search:
    """The search for a plan of one task.

    Attributes:
        task: Task to plan.
        planner: Running planner process.
        original: Task whose plans are wanted. By default, the task to plan.
        restore: Function that converts a plan of the task to a plan of the original task.
        expectations: Expectations of instances, which several searches may share.
        stages: Maps each stage to its duration so far [s].
        waits: Whether helpers served groups of goals one after another.
        deadline: Deadline of the command.
        refusals: Reasons why plans were refused.
        broken: Pairs of a feasibility condition that failed in a predicted state, and its instance in a refused plan.
        best: Best lawful plan so far, or None.
    """

    def __init__(
        self,
        task: Task,
        planner: Planner,
        deadline: Deadline | None = None,
        original: Task | None = None,
        restore: Callable[[TaskPlan], TaskPlan] = lambda plan: plan,
        expectations: Expectations | None = None,
    ) -> None:
        self.task = task
        self.planner = planner
        self.original = original or task
        self.restore = restore
        self.expectations = expectations or Expectations()
        self.deadline = deadline or Deadline.after(task.limits.time)
        self.best: Candidate | None = None
        self.stages: defaultdict[str, float] = defaultdict(float)
        self.waits, self.refusals = False, list[str]()
        self.broken: list[tuple[BrokenCondition, BlockInstance]] = []
        self._began = self._counted = time.monotonic()
        self._open: list[str] = []

    @property
    def elapsed(self) -> float:
        """Time since the search began [s]."""
        return time.monotonic() - self._began

    @property
    def engine(self) -> str:
        """Name of the engine to ask. No search for fewer actions is made if the makespan is minimised."""
        shortens = self.task.planner == SHORTENING and self.task.objective == "makespan"
        return FIRST if shortens else self.task.planner

    @cached_property
    def compilation(self) -> Compilation:
        """The compiled task. The compilations of goal groups use the same PDDL names."""
        with self.stage("compiling"):
            return compile_task(self.task)

    @cached_property
    def estimates(self) -> Estimates:
        """The estimates of the instances of the task."""
        return Estimates(self.task, self.deadline, self.expectations)

    @cached_property
    def _predictions(self) -> Estimates:
        whole = self.original is self.task
        return self.estimates if whole else Estimates(self.original, self.deadline, self.expectations)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Measure the duration of a stage, excluding nested stages."""
        self._count()
        self._open.append(name)
        try:
            yield
        finally:
            self._count()
            self._open.pop()

    def _count(self) -> None:
        now = time.monotonic()
        if self._open:
            self.stages[self._open[-1]] += now - self._counted
        self._counted = now

    @contextmanager
    def limits_of_request(self) -> Iterator[Limits]:
        """Measure the duration of a request to the engine and yield the limits of the request.

        Every request can use all the remaining time. A smaller share would let the clock decide which plan is found.

        Raises:
            LimitReached: If the request reached a limit, or if no time is left for the request.
        """
        self.deadline.check()
        try:
            with self.stage("planner"):
                yield replace(self.task.limits, time=self.deadline.left)
        except LimitReached:
            # The engine reports the remaining time. The user only knows the time limit of the command.
            self.deadline.check()
            raise

    def judge_actions(self, way: str, actions: Sequence[PlannedAction]) -> Candidate | None:
        """Convert actions to a lawful plan of the whole task. If this fails, record the reason and return None."""
        try:
            candidate = self._schedule(way, actions)
        except NotAPlanError as error:
            self._refuse(way, str(error))
            return None
        return self.judge(candidate)

    def try_actions(self, way: str, actions: Sequence[PlannedAction]) -> Candidate | None:
        """Convert actions to a lawful plan of the whole task, or return None. Nothing is recorded about a refused plan.

        A plan that was shortened by trial and error may break the law. This is no fault of the engine.
        """
        try:
            candidate = self._schedule(way, actions)
        except NotAPlanError:
            return None
        restored, violations, broken = self._examine(candidate)
        return None if violations or broken else self._keep(restored)

    def _schedule(self, way: str, actions: Sequence[PlannedAction]) -> Candidate:
        compilation = self.compilation
        with self.stage("scheduling"):
            return Candidate(way, schedule_actions(compilation, actions, self.estimates))

    def judge(self, candidate: Candidate) -> Candidate | None:
        """Return the candidate as a plan of the original task, or record the reason for refusing it and return None.

        The plan must obey the law of assignment. Its feasibility conditions must hold in the predicted states. The plan
        becomes the best plan if its makespan is the shortest so far.
        """
        restored, violations, broken = self._examine(candidate)
        if violations:
            self._refuse(candidate.way, "; ".join(each.text for each in violations))
            return None
        if broken:
            encoded = {instance.name: instance for instance in candidate.plan.instances}
            self.broken += [(each, encoded[each.instance.name]) for each in broken]
            self._refuse(candidate.way, "; ".join(each.text for each in broken), logging.INFO)
            return None
        return self._keep(restored)

    def _examine(self, candidate: Candidate) -> tuple[Candidate, list[Violation], list[BrokenCondition]]:
        """Return the candidate as a plan of the original task, with its violations of the law and broken conditions."""
        restored = replace(candidate, plan=self.restore(candidate.plan))
        with self.stage("law"):
            if violations := check_law(self.original, restored.plan):
                return restored, violations, []
            return restored, [], list(find_broken_conditions(self.original, restored.plan, self._predictions))

    def _keep(self, candidate: Candidate) -> Candidate:
        if self.best is None or candidate.plan.makespan < self.best.plan.makespan - 1e-6:
            self.best = candidate
        return candidate

    def _refuse(self, way: str, reason: str, level: int = logging.WARNING) -> None:
        """Record why a plan is refused. A plan that breaks the law is a fault, which deserves a warning."""
        _LOG.log(level, "the plan of %s (%s) was refused: %s", self.task.planner, way, reason)
        self.refusals.append(reason)
