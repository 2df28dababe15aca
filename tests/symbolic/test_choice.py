"""Tests of goals with a choice: the best plan is used, and 'unsolvable' means that all alternatives are unsolvable."""

import json
from collections.abc import Collection
from pathlib import Path

import numpy as np
import pytest
from scenes import rolling_task
from serial import COLOURS, Part, block, changing, domain, task

import hybrid_tamp
from hybrid_tamp.errors import InputError, LimitReached
from hybrid_tamp.model.kind import Kind
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.predicate import ANY, Atom, Parameter, Predicate
from hybrid_tamp.model.task import Limits, Task
from hybrid_tamp.report.folder import RunFolder
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerAnswer, PlannerProcess
from hybrid_tamp.symbolic.find_plan import find_plan
from hybrid_tamp.symbolic.pddl.operators import PlanningProblem
from hybrid_tamp.symbolic.temporal.compilation import compile_durative
from hybrid_tamp.taskfile.loader import load_task
from hybrid_tamp.verbs.pddl import export
from hybrid_tamp.verbs.plan import save_plan

EITHER = Path(__file__).parents[2] / "problems" / "roll_to_either_region.yaml"
SOME = Atom("inside", ("drum 0", ANY))
PAINTED = Predicate(
    "painted",
    (Parameter("part", Part), Parameter("colour", COLOURS)),
    lambda state, part, colour: np.asarray(-1.0 - COLOURS.symbols.index(colour)),
    kind=Kind.FUNCTIONAL,
    value_of="colour",
)


def some_region(*regions: tuple[float, float]) -> Task:
    return rolling_task(regions=regions).replaced(goal=(SOME,))


def painting() -> Task:
    """Return a task in which red is the nearest colour but takes two blocks, and green takes one."""
    primed = changing("primed", Part)
    prime = block("PRIMING", {"part": Part}, [], [primed("part")])
    red = block("RED", {"part": Part}, [primed("part")], [PAINTED("part", "red")])
    green = block("GREEN", {"part": Part}, [], [PAINTED("part", "green")])
    edges = [(one, other) for name in ("PRIMING", "RED", "GREEN") for one, other in _both(f"{name}.part")]
    return task(domain([prime, red, green], [primed, PAINTED], edges), [("painted", "part 0", ANY)])


def _both(slot: str) -> list[tuple[str, str]]:
    return [("RESTING.token", slot), (slot, "RESTING.token")]


class Slow:
    """A planner that reaches its limit on the problems with given numbers (from 1), and records its time limits."""

    def __init__(self, planner: PlannerProcess, failing: Collection[int] = ()) -> None:
        self.planner = planner
        self.failing = failing
        self.given: list[float] = []

    def solve(self, problem: PlanningProblem, engine: str, limits: Limits) -> PlannerAnswer:
        self.given.append(limits.time)
        if len(self.given) in self.failing:
            raise LimitReached("too late", limit="time")
        return self.planner.solve(problem, engine, limits)


def test_the_region_that_works_is_found() -> None:
    given = load_task(EITHER)
    outcome = hybrid_tamp.plan(given)
    plan = outcome.required()
    assert outcome.task is given
    assert outcome.chosen is not None
    assert outcome.chosen.goal == (Atom("inside", ("drum", "far")),)
    assert check_law(given, plan) == check_law(outcome.chosen, plan) == []


def test_of_equal_plans_the_nearer_goal_wins() -> None:
    with PlannerProcess() as planner:
        planned = find_plan(some_region((0.9, 0.0), (0.6, 0.0)), planner)
    assert planned.task is not None
    assert planned.task.goal[0].arguments[1] == "region 1"


def test_a_shorter_plan_beats_a_nearer_goal() -> None:
    given = painting()
    assert [each.goal[0].arguments[1] for each in given.alternatives()] == ["red", "green", "blue"]
    with PlannerProcess() as planner:
        planned = find_plan(given, planner)
    assert planned.task is not None
    assert planned.task.goal[0].arguments[1] == "green"
    assert planned.task.limits == given.limits


def test_the_first_choice_that_holds_already_ends_the_search() -> None:
    with PlannerProcess() as process:
        planner = Slow(process)
        planned = find_plan(some_region((0.9, 0.0), (0.0, 0.0)), planner)
    assert planned.plan is not None
    assert (planned.plan.actions, len(planner.given)) == ((), 1)


def test_unsolvable_is_proven_for_each_and_explained_for_each() -> None:
    outcome = hybrid_tamp.plan(some_region((0.7, 0.1), (0.9, 0.2)))
    assert outcome.status == "unsolvable"
    assert "inside(drum 0, region 0): ROLLING" in str(outcome.error)
    assert "inside(drum 0, region 1): ROLLING" in str(outcome.error)


def test_every_alternative_may_use_all_the_time_that_is_left() -> None:
    with PlannerProcess() as process:
        planner = Slow(process)
        find_plan(some_region((0.6, 0.0), (0.9, 0.0)).replaced(limits=Limits(time=400.0)), planner)
    assert len(planner.given) == 2
    assert all(300 < given <= 400 for given in planner.given)


def test_an_alternative_that_takes_too_long_ends_the_search_with_the_best_so_far() -> None:
    given = some_region((0.6, 0.0), (0.9, 0.0))
    with PlannerProcess() as process:
        with pytest.raises(LimitReached, match="too late"):
            find_plan(given, Slow(process, {1}))
        planned = find_plan(given, Slow(process, {2}))
    assert planned.task is not None
    assert planned.task.goal[0].arguments[1] == "region 0"
    assert str(planned.stopped) == "too late"


def test_an_alternative_out_of_reach_needs_no_engine() -> None:
    with PlannerProcess() as process:
        planner = Slow(process, {1})
        planned = find_plan(some_region((0.6, 0.1), (0.9, 0.1)), planner)
    assert (planned.status, planner.given) == ("unsolvable", [])


def test_pddl_needs_a_goal_without_a_choice(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path)
    given = some_region((0.6, 0.1), (0.9, 0.0))
    for encoding in ("classical", "temporal"):
        with pytest.raises(InputError, match="2 choices; name tokens instead of '\\*'; the nearest choice is inside"):
            export(given, folder, encoding=encoding)
    assert compile_task(some_region((0.6, 0.0))).goal == compile_task(rolling_task(regions=[(0.6, 0.0)])).goal
    one = compile_durative(some_region((0.6, 0.0))).problem
    assert one.goal == compile_durative(rolling_task(regions=[(0.6, 0.0)])).problem.goal
    export(given, folder, hybrid_tamp.plan(given).required())
    assert "(inside drum-0 region-1)" in (tmp_path / "problem.pddl").read_text()


def test_a_choice_that_cannot_be_made_leaves_the_document_alone(tmp_path: Path) -> None:
    save_plan(hybrid_tamp.plan(some_region((0.7, 0.1), (0.9, 0.2))), RunFolder.create(tmp_path))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plan.json", "task.yaml"]
    assert json.loads((tmp_path / "plan.json").read_text())["status"] == "unsolvable"
