"""Tests of goals that are planned separately. The merged plan is checked for the whole task."""

import time
from collections.abc import Iterator
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
from clocks import hurried
from hypothesis import given
from hypothesis import strategies as st
from random_tasks.tumbling import random_tumbling
from scenes import rolling_task
from validation import val_accepts

from hybrid_tamp.errors import LimitReached
from hybrid_tamp.model.facts import facts, static_facts
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Limits, Task
from hybrid_tamp.planning.plan import plan_task
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerAnswer, PlannerProcess
from hybrid_tamp.symbolic.engines.registry import FIRST
from hybrid_tamp.symbolic.find_plan import WHOLE, find_plan
from hybrid_tamp.symbolic.pddl.operators import PlanningProblem
from hybrid_tamp.symbolic.strategies.allocation import cheapest_matching
from hybrid_tamp.symbolic.strategies.goals_apart import APART, plan_goals_apart
from hybrid_tamp.symbolic.strategies.groups import goal_groups, helpers, least_helpers, most_helpers, own_task
from hybrid_tamp.symbolic.strategies.in_turn import IN_TURN
from hybrid_tamp.symbolic.strategies.needless import WITHOUT_NEEDLESS
from hybrid_tamp.symbolic.strategies.search import Search, SearchResult


class Counting:
    """A planner that records its requests."""

    def __init__(self, planner: PlannerProcess) -> None:
        self.planner = planner
        self.asked: list[PlanningProblem] = []

    def solve(self, problem: PlanningProblem, engine: str, limits: Limits) -> PlannerAnswer:
        self.asked.append(problem)
        return self.planner.solve(problem, engine, limits)


@pytest.fixture
def planner() -> Iterator[Counting]:
    with PlannerProcess() as process:
        yield Counting(process)


def accepted(folder: Path, task: Task, planned: SearchResult) -> bool:
    """Return whether the law checker and VAL accept the plan of the whole task."""
    assert planned.plan is not None
    lawful = check_law(task, planned.plan) == []
    return lawful and val_accepts(folder, compile_task(task).problem, planned.answer.actions)


def test_three_boxes_take_as_long_as_one_and_one_search_does_for_all(planner: Counting, tmp_path: Path) -> None:
    one = find_plan(random_tumbling(7, 2, 1), planner)
    assert (one.way, len(planner.asked)) == (WHOLE, 1)
    task = random_tumbling(7, 6, 3)
    three = find_plan(task, planner)
    assert three.way.startswith(APART)
    assert len(planner.asked) == 2
    assert accepted(tmp_path, task, three)
    assert one.plan is not None
    assert three.plan is not None
    assert three.plan.makespan <= 1.1 * one.plan.makespan
    assert len(three.plan.actions) == 3 * len(one.plan.actions)


def test_hands_serve_one_box_after_the_other_where_they_are_few(planner: Counting, tmp_path: Path) -> None:
    task = random_tumbling(3, 2, 2)
    planned = find_plan(task, planner)
    assert planned.way.startswith(APART)
    assert accepted(tmp_path, task, planned)


def test_more_hands_make_one_box_quicker(planner: Counting) -> None:
    tasks = [random_tumbling(7, hands, 1).replaced(objective="makespan") for hands in (2, 4)]
    two, four = (plan_goals_apart(Search(task, planner), first_will_do=False) for task in tasks)
    assert two is not None
    assert four is not None
    assert four.plan.makespan < 0.85 * two.plan.makespan


def test_drums_roll_apart_each_to_its_region(planner: Counting, tmp_path: Path) -> None:
    places = [(0.0, 0.6 * row) for row in range(3)]
    regions = [(0.7, 0.6 * row) for row in range(3)]
    task = rolling_task(1, places, regions, [(0, 0), (1, 1), (2, 2)]).replaced(planner=FIRST)
    planned = find_plan(task, planner)
    assert planned.way.startswith(APART)
    assert accepted(tmp_path, task, planned)


def test_the_group_that_waits_for_a_hand_is_the_one_that_makes_the_plan_shortest(planner: Counting) -> None:
    """The hand starts behind the second drum, so the first drum waits, although it is first in the goal."""
    apart = rolling_task(1, [(0, 0), (0, 1.5)], [(0.7, 0), (0.7, 1.5)], [(0, 0), (1, 1)])
    near = apart.replaced(state=apart.state.replace({("hand 0", "position"): (-0.3, 1.5, 0.3)}))
    orders = []
    for task in (apart, near):
        found = plan_goals_apart(Search(task.replaced(objective="makespan"), planner), first_will_do=False)
        assert found is not None
        orders.append([each.slots["object"] for each in found.plan.instances if each.block == "ROLLING"])
    assert orders == [["drum 0", "drum 1"], ["drum 1", "drum 0"]]


def test_what_has_no_plan_is_proven_with_the_whole_task(planner: Counting) -> None:
    planned = find_plan(random_tumbling(3, 1, 2), planner)
    assert (planned.status, planned.plan) == ("unsolvable", None)
    _with_preferences, asked = planner.asked
    assert asked == compile_task(random_tumbling(3, 1, 2)).problem


def test_an_optimal_engine_is_asked_for_the_whole_task(planner: Counting) -> None:
    task = rolling_task(2, [(0, 0), (0, 0.6)], [(0.7, 0), (0.7, 0.6)], [(0, 0), (1, 1)])
    planned = find_plan(task.replaced(planner="symk-opt"), planner)
    assert planned.way == WHOLE
    assert find_plan(task.replaced(planner=FIRST), planner).way.startswith(APART)


def test_a_small_task_is_planned_at_once_to_find_the_fewest_actions(planner: Counting) -> None:
    """Planned separately, one hand rests between two drums until needless actions are dropped."""
    task = rolling_task(1, [(0, 0), (0, 0.6)], [(0.7, 0), (0.7, 0.6)], [(0, 0), (1, 1)])
    at_once, apart = find_plan(task, planner), find_plan(task.replaced(planner=FIRST), planner)
    assert (at_once.way, at_once.fewest, apart.fewest) == (WHOLE, "proven fewest", "first found")
    assert apart.way.startswith(APART)
    assert apart.way.endswith(WITHOUT_NEEDLESS)
    assert len(at_once.answer.actions) == len(apart.answer.actions)


def test_few_groups_are_planned_in_turn_with_more_hands(planner: Counting, tmp_path: Path) -> None:
    task = random_tumbling(7, 4, 2).replaced(objective="length")
    planned = find_plan(task, planner)
    assert planned.way.startswith(IN_TURN)
    assert planned.fewest == "no shorter one found"
    assert accepted(tmp_path, task, planned)
    assert len(planned.answer.actions) < 34


class Breaking:
    """A planner that finds the first plans and reaches its limit on the next problem."""

    def __init__(self, planner: PlannerProcess, solved: int) -> None:
        self.planner = planner
        self.solved = solved

    def solve(self, problem: PlanningProblem, engine: str, limits: Limits) -> PlannerAnswer:
        self.solved -= 1
        if self.solved < 0:
            raise LimitReached("too late", limit="time")
        return self.planner.solve(problem, engine, limits)


def test_a_group_that_takes_long_is_not_a_group_without_a_plan() -> None:
    task = random_tumbling(7, 4, 2)
    with PlannerProcess() as process, pytest.raises(LimitReached, match="too late"):
        find_plan(task, Breaking(process, 0))


def test_where_a_limit_ends_the_search_for_a_shorter_plan_the_best_so_far_is_kept() -> None:
    task = random_tumbling(7, 4, 1).replaced(objective="makespan")
    with PlannerProcess() as process:
        planned = find_plan(task, Breaking(process, 1))
        assert planned.plan is not None
        assert str(planned.stopped) == "too late"
        outcome = plan_task(task, Breaking(process, 1))
    assert (outcome.status, outcome.steps) != ("solved", ())
    assert outcome.plan is not None
    with pytest.raises(LimitReached, match="too late"):
        outcome.required()


@pytest.mark.parametrize("objective", ["length", "makespan"])
def test_no_clock_decides_which_plan_is_found(
    planner: Counting, objective: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    task = random_tumbling(7, 4, 2).replaced(objective=objective, limits=Limits(time=1e6))
    idle = find_plan(task, planner)
    asked = len(planner.asked)
    hurried(monkeypatch, jump=10.0)
    busy = find_plan(task, planner)
    assert (busy.way, busy.plan) == (idle.way, idle.plan)
    assert len(planner.asked) == 2 * asked


class Slow:
    """A planner that always reaches its time limit."""

    def solve(self, problem: PlanningProblem, engine: str, limits: Limits) -> PlannerAnswer:
        time.sleep(limits.time)
        raise LimitReached(f"{limits.time:g} s are over", limit="time")


@pytest.mark.parametrize("boxes", [1, 2])
def test_the_time_limit_is_that_of_the_task_however_many_parts_there_are(boxes: int) -> None:
    task = random_tumbling(3, 2 * boxes, boxes).replaced(limits=Limits(time=1.5))
    began = time.monotonic()
    with pytest.raises(LimitReached, match=r"time limit of 1\.5 s"):
        find_plan(task, Slow())
    assert time.monotonic() - began < 10.0


def test_goals_that_share_a_token_belong_together() -> None:
    task = rolling_task(2, [(0, 0), (0, 0.6)], [(0.7, 0), (0.7, 0.6)], [(0, 0), (1, 1), (0, 1)])
    one, other = goal_groups(task, facts(task))
    assert one.goal == (Atom("inside", ("drum 0", "region 0")), Atom("inside", ("drum 0", "region 1")))
    assert (one.tokens, one.places) == (("drum 0",), ("region 0", "region 1"))
    assert other.tokens == ("drum 1",)
    assert [token.name for token in helpers(task)] == ["hand 0", "hand 1"]
    assert goal_groups(task, set(task.goal)) == []


def test_how_many_helpers_a_group_can_need() -> None:
    task = random_tumbling(3, 4, 2)
    (group, _) = goal_groups(task, facts(task))
    assert least_helpers(task, group, facts(task)) == 2
    assert most_helpers(task) == 4


def test_a_part_says_what_the_whole_says() -> None:
    task = random_tumbling(3, 4, 2)
    group = goal_groups(task, facts(task))[0]
    part = own_task(task, group, ["hand 2"], [])
    assert {token.name for token in part.tokens} == {"box 1", "hand 2"}
    names = {token.name for token in task.tokens} - {token.name for token in part.tokens}
    for mine, theirs in ((static_facts(part), static_facts(task)), (facts(part), facts(task))):
        assert mine == {atom for atom in theirs if not names & set(atom.arguments)}


@given(st.integers(1, 4), st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_no_matching_is_cheaper(rows: int, columns: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    costs = rng.integers(0, 5, (rows, columns)).astype(float)
    costs[rng.uniform(size=costs.shape) < 0.3] = np.inf
    totals = [sum(costs[row, column] for row, column in enumerate(each)) for each in permutations(range(columns), rows)]
    matched = cheapest_matching(costs)
    if matched is None:
        assert not np.isfinite(min(totals, default=np.inf))
    else:
        assert len(set(matched)) == rows
        assert sum(costs[row, column] for row, column in enumerate(matched)) == min(totals)
