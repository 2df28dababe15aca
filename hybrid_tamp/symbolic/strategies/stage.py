"""The whole symbolic stage: every way to a plan that is worth a try, and of the lawful plans the best.

A *way* yields candidates, each judged by the law already: the whole task at once, independent goals apart, the same
plan with interchangeable tokens rebound. For the number of actions the first lawful plan is taken; for the makespan
all ways are tried while there is time, and the shortest plan wins.
"""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.engines.planner_process import PlannerAnswer
from hybrid_tamp.symbolic.strategies.apart.goals_apart import GoalsApart
from hybrid_tamp.symbolic.strategies.makespan import shortened
from hybrid_tamp.symbolic.strategies.search import Candidate, Planner, Search

__all__ = ["Planned", "Planner", "plan_task"]

SHORTENING = 15.0
"""How long shorter plans are looked for when the objective is the makespan [s]."""

WHOLE = "the whole task at once"
REBOUND = "interchangeable tokens rebound"

_DECOMPOSING = ("fast-downward", "symk", "enhsp", "pyperplan")
"""Engines that end where a part has no plan, and whose plans are not expected to be the shortest in actions."""


@dataclass(frozen=True)
class Planned:
    """What came of asking a planner.

    Attributes:
        answer: the engine's own answer; where there is a plan, with the actions of that plan.
        plan: the checked timeline, or None.
        refusal: why the engine's plan was refused, or empty.
        way: how the plan was found.
        proven: whether no plan has a shorter makespan.
        stages: seconds that each stage took.
        task: the task that was planned: of a goal with a choice, the one that was chosen, or else the nearest.
    """

    answer: PlannerAnswer
    plan: TaskPlan | None
    refusal: str = ""
    way: str = ""
    proven: bool = False
    stages: Mapping[str, float] = field(default_factory=dict)
    task: Task | None = None

    @property
    def status(self) -> str:
        """``solved``, ``unsolvable``, ``not_found``, ``planner_crashed`` or ``plan_refused``."""
        if self.plan is not None:
            return "solved"
        if self.refusal:
            return "plan_refused"
        return {"crashed": "planner_crashed", "refused": "plan_refused"}.get(self.answer.status, self.answer.status)


def plan_task(task: Task, planner: Planner) -> Planned:
    """Return a plan that the law checker passed, or why there is none.

    Every action of it comes from plans that unified-planning's validator passed. Where the goal leaves a choice, the
    best plan of all alternatives is returned; that there is none is proven if it is for each of them.

    Args:
        task: the task.
        planner: a running planner process.

    Raises:
        InputError: the engine is not installed or not known, or the goal cannot be compiled.
        LimitReached: the engine ran into the time or memory limit.
    """
    alternatives = task.alternatives()
    if len(alternatives) == 1:
        return _planned(alternatives[0], planner, SHORTENING)
    return _Choice(task, alternatives, planner).best()


def _planned(task: Task, planner: Planner, shortening: float) -> Planned:
    """Plan a task whose goal leaves no choice, looking for shorter plans for so long [s]."""
    stage = _Stage(Search(task, planner), shortening)
    best = stage.best()
    search = stage.search
    if best is not None:
        answer = PlannerAnswer("solved", best.plan.actions, search.elapsed, task.planner, validated=True)
        return Planned(answer, best.plan, "", best.way, best.proven, dict(search.stages), task)
    assert stage.answer is not None, "the way of the whole task asks the planner, or raises"
    refusal = search.refusals[-1] if search.refusals and stage.answer.status == "solved" else ""
    return Planned(replace(stage.answer, seconds=search.elapsed), None, refusal, stages=dict(search.stages), task=task)


class _Choice:
    """A goal with a choice: every alternative is planned, the nearest first, with a fair share of the time."""

    def __init__(self, task: Task, alternatives: Sequence[Task], planner: Planner) -> None:
        self._task = task
        self._alternatives = alternatives
        self._planner = planner
        self._began = time.monotonic()
        self._found: list[Planned] = []
        self._limits: list[LimitReached] = []

    @property
    def _elapsed(self) -> float:
        return time.monotonic() - self._began

    def best(self) -> Planned:
        """Return the best plan by the objective, of equal ones the nearest; or why there is none.

        Raises:
            LimitReached: there is no plan, and not every alternative was decided.
        """
        for number, task in enumerate(self._alternatives):
            share = (self._task.limits.time - self._elapsed) / (len(self._alternatives) - number)
            try:
                found = _planned(self._limited(task, share), self._planner, SHORTENING / len(self._alternatives))
            except LimitReached as reached:
                self._limits.append(reached)
                continue
            self._found.append(replace(found, task=task))
            if found.plan is not None and not found.plan.actions:
                break  # Nothing is shorter than nothing.
        solved = [found for found in self._found if found.plan is not None]
        if not solved and self._limits:
            raise self._limit()
        undecided = [found for found in self._found if found.status != "unsolvable"]
        return self._summed(min(solved, key=self._cost) if solved else [*undecided, *self._found][0])

    def _limited(self, task: Task, seconds: float) -> Task:
        return task.replaced(limits=replace(task.limits, time=max(seconds, 0.0)))

    def _cost(self, found: Planned) -> float:
        assert found.plan is not None
        return found.plan.makespan if self._task.objective == "makespan" else float(len(found.plan.actions))

    def _limit(self) -> LimitReached:
        other = next((reached for reached in self._limits if reached.limit != "time"), None)
        message = f"the planner reached its time limit of {self._task.limits.time:g} s"
        return other or LimitReached(message, limit="time")

    def _summed(self, chosen: Planned) -> Planned:
        """Return what was chosen, with the time that all alternatives took."""
        stages = {name: sum(found.stages.get(name, 0.0) for found in self._found) for name in chosen.stages}
        others = (found.proven or found.status == "unsolvable" for found in self._found)
        proven = chosen.proven and not self._limits and all(others)
        return replace(chosen, answer=replace(chosen.answer, seconds=self._elapsed), proven=proven, stages=stages)


Way = Callable[[Candidate | None], Iterator[Candidate]]
"""Takes the best plan so far and yields lawful plans that may be better."""


class _Stage:
    """The ways to a plan of one task.

    Attributes:
        search: what they share.
        shortening: how long shorter plans are looked for [s].
        answer: the planner's answer to the whole task, once it was asked for.
    """

    def __init__(self, search: Search, shortening: float) -> None:
        self.search = search
        self.shortening = shortening
        self.task = search.task
        self.answer: PlannerAnswer | None = None
        with search.stage("compiling"):
            self.apart = GoalsApart(search, shortening)

    def best(self) -> Candidate | None:
        """Return the best plan of all ways that are tried, or None."""
        if self.task.objective != "makespan":
            return next(self._first_come(), None)
        best: Candidate | None = None
        for way in self._ways():
            for candidate in way(best):
                if best is None or candidate.plan.makespan < best.plan.makespan - 1e-6:
                    best = candidate
                if best.proven or self.search.elapsed > self.shortening:
                    return best
        return best

    def _first_come(self) -> Iterator[Candidate]:
        if self.task.planner in _DECOMPOSING and self.apart.worthwhile:
            yield from self._apart(None)
        yield from self._whole(None)

    def _ways(self) -> list[Way]:
        """Return the ways to a short makespan, the most promising first; each is told the best plan so far.

        Further ways are put in here; what they yield has been judged by `Search.judged` or `Search.candidate`.
        """
        apart = [self._apart] if self.task.planner in _DECOMPOSING else []
        return [*apart, self._whole, self._rebound]

    def _apart(self, best: Candidate | None) -> Iterator[Candidate]:
        """Plan the goals apart, with several numbers of helpers."""
        candidates = self.apart.candidates()
        while True:
            with self.search.stage("compiling"):
                found = next(candidates, None)
            if found is None:
                return
            yield found

    def _whole(self, best: Candidate | None) -> Iterator[Candidate]:
        """Ask for a plan of the whole task, unless its parts have one."""
        if best is not None:
            return
        with self.search.stage("compiling"):
            problem = self.search.compilation.problem
        self.answer = self.search.ask(problem)
        if self.answer.status == "solved":
            found = self.search.candidate(WHOLE, self.answer.actions)
            if found is not None:
                yield found

    def _rebound(self, best: Candidate | None) -> Iterator[Candidate]:
        """Rebind interchangeable tokens of the best plan."""
        if best is not None:
            seconds, compilation = self.shortening - self.search.elapsed, self.search.compilation
            with self.search.stage("scheduling"):
                shorter = shortened(compilation, best.plan, best.plan.actions, seconds, self.search.estimates)
            if shorter is not best.plan:
                found = self.search.judged(Candidate(f"{best.way}, {REBOUND}", shorter))
                if found is not None:
                    yield found
