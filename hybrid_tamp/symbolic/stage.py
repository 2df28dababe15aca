"""The whole symbolic stage: every way to a plan that is worth a try, and of the lawful plans the best.

A *way* yields candidates, each judged by the law already: the whole task at once, independent goals apart, the same
plan with interchangeable tokens rebound. For the number of actions the first lawful plan is taken; for the makespan
all ways are tried while there is time, and the shortest plan wins.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.apart.goals_apart import GoalsApart
from hybrid_tamp.symbolic.engines import is_installed
from hybrid_tamp.symbolic.makespan import shortened
from hybrid_tamp.symbolic.planner import PlannerAnswer
from hybrid_tamp.symbolic.search import Candidate, Planner, Search

__all__ = ["Planned", "Planner", "plan_task"]

SHORTENING = 15.0
"""How long shorter plans are looked for when the objective is the makespan [s]."""

ARRANGING = 8.0
"""How long Aries arranges durative actions, of that time [s]."""

WHOLE = "the whole task at once"
REBOUND = "interchangeable tokens rebound"
ARRANGED = "arranged by Aries"

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
    """

    answer: PlannerAnswer
    plan: TaskPlan | None
    refusal: str = ""
    way: str = ""
    proven: bool = False
    stages: Mapping[str, float] = field(default_factory=dict)

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

    Every action of it comes from plans that unified-planning's validator passed.

    Args:
        task: the task.
        planner: a running planner process.

    Raises:
        InputError: the engine is not installed or not known, or the goal cannot be compiled.
        LimitReached: the engine ran into the time or memory limit.
    """
    stage = _Stage(Search(task, planner))
    best = stage.best()
    search = stage.search
    if best is not None:
        answer = PlannerAnswer("solved", best.actions, search.elapsed, task.planner, validated=True)
        return Planned(answer, best.plan, "", best.way, best.proven, dict(search.stages))
    assert stage.answer is not None, "the way of the whole task asks the planner, or raises"
    refusal = search.refusals[-1] if search.refusals and stage.answer.status == "solved" else ""
    return Planned(replace(stage.answer, seconds=search.elapsed), None, refusal, stages=dict(search.stages))


Way = Callable[[Candidate | None], Iterator[Candidate]]
"""Takes the best plan so far and yields lawful plans that may be better."""


class _Stage:
    """The ways to a plan of one task.

    Attributes:
        search: what they share.
        answer: the planner's answer to the whole task, once it was asked for.
    """

    def __init__(self, search: Search) -> None:
        self.search = search
        self.task = search.task
        self.answer: PlannerAnswer | None = None
        with search.stage("compiling"):
            self.apart = GoalsApart(search, SHORTENING)

    def best(self) -> Candidate | None:
        """Return the best plan of all ways that are tried, or None."""
        if self.task.objective != "makespan":
            return next(self._first_come(), None)
        best: Candidate | None = None
        for way in self._ways():
            for candidate in way(best):
                if best is None or candidate.plan.makespan < best.plan.makespan - 1e-6:
                    best = candidate
                if best.proven or self.search.elapsed > SHORTENING:
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
        aries = [self._arranged] if is_installed("aries") else []
        return [*apart, self._whole, self._rebound, *aries]

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
            seconds, compilation = SHORTENING - self.search.elapsed, self.search.compilation
            with self.search.stage("scheduling"):
                shorter = shortened(compilation, best.plan, best.actions, seconds, self.search.estimates)
            if shorter is not best.plan:
                found = self.search.judged(Candidate(f"{best.way}, {REBOUND}", shorter))
                if found is not None:
                    yield found

    def _arranged(self, best: Candidate | None) -> Iterator[Candidate]:
        """Have Aries arrange what the best plan needs, in durative actions."""
        if best is None:
            return
        # Only this way needs the modules of durative actions.
        from hybrid_tamp.symbolic.temporal.arranging import Durative

        seconds = min(ARRANGING, SHORTENING - self.search.elapsed)
        with self.search.stage("compiling"):
            plans = Durative(self.task, self.search.compilation, self.search.estimates).shorter(best.plan, seconds)
        while True:
            with self.search.stage("planner"):
                plan = next(plans, None)
            if plan is None:
                return
            yield Candidate(f"{best.way}, {ARRANGED}", plan)
