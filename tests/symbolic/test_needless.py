"""Needless actions, which are dropped from the plans of all engines."""

from collections import Counter
from collections.abc import Iterator

import pytest
from random_tasks.several import several_task
from scenes import rolling_task

from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import PlannedAction
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.decode import decode
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.engines.registry import FIRST
from hybrid_tamp.symbolic.strategies.needless import WITHOUT_NEEDLESS, drop_needless, encode_again
from hybrid_tamp.symbolic.strategies.search import Candidate, Search

BLOCKS, DRUMS, BOX = 18, 5, 19
"""Seeds of random tasks with several blocks and a hammer, with several drums, and with a box."""


@pytest.fixture
def planner() -> Iterator[PlannerProcess]:
    with PlannerProcess() as process:
        yield process


def first_plan(task: Task, planner: PlannerProcess, objective: str = "length") -> tuple[Search, Candidate]:
    """Return the first plan of the engine, with all needless actions."""
    search = Search(task.replaced(planner=FIRST, objective=objective), planner)
    answer = planner.solve(search.compilation.problem, FIRST, task.limits)
    candidate = search.judge_actions("the first plan", answer.actions)
    assert candidate is not None
    return search, candidate


def counted(candidate: Candidate) -> Counter[str]:
    return Counter(instance.action for instance in candidate.plan.instances)


def test_a_tool_that_is_put_down_and_taken_up_again_stays_in_the_hand(planner: PlannerProcess) -> None:
    search, first = first_plan(several_task(BLOCKS), planner)
    found = drop_needless(search, first)
    assert counted(first)["GRASPING"] > 1
    assert counted(first)["RELEASING"] > 0
    assert counted(found)["GRASPING"] == 1
    assert len(found.plan.actions) <= 0.8 * len(first.plan.actions)
    assert found.way.endswith(WITHOUT_NEEDLESS)
    assert check_law(search.task, found.plan) == []
    assert search.compilation.reaches_goal(found.plan.actions)
    # A refused plan is no fault, so nothing is recorded.
    assert (search.refusals, search.broken) == ([], [])


def test_a_hand_that_reaches_twice_reaches_once(planner: PlannerProcess) -> None:
    """A handwritten detour: the hand reaches behind the drum, rests, and reaches again."""
    search, first = first_plan(rolling_task(), planner)
    reach = first.plan.actions[0]
    assert reach.name == "begin-reaching-behind-from-resting"
    hand, drum, region, *count = reach.arguments
    rest = PlannedAction("begin-resting-from-reaching-behind", (hand, drum, region, *reversed(count)))
    detour = search.judge_actions("a detour", [reach, rest, *first.plan.actions])
    assert detour is not None
    assert drop_needless(search, detour).plan.actions == first.plan.actions


def test_a_plan_without_needless_actions_stays(planner: PlannerProcess) -> None:
    search, first = first_plan(rolling_task(), planner)
    assert drop_needless(search, first) is first


def test_the_work_is_counted(planner: PlannerProcess) -> None:
    search, first = first_plan(several_task(BLOCKS), planner)
    instances = len(decode(search.compilation, first.plan.actions))
    assert drop_needless(search, first, most_instances=instances - 1) is first
    assert drop_needless(search, first) == drop_needless(search, first)


def test_dropped_actions_do_not_extend_the_makespan(planner: PlannerProcess) -> None:
    search, first = first_plan(several_task(BLOCKS), planner, "makespan")
    assert drop_needless(search, first).plan.makespan <= first.plan.makespan


@pytest.mark.parametrize("seed", [BLOCKS, DRUMS, BOX])
def test_instances_are_encoded_as_the_actions_of_their_plan(seed: int, planner: PlannerProcess) -> None:
    search, first = first_plan(several_task(seed), planner)
    again = encode_again(search.compilation, decode(search.compilation, first.plan.actions))
    assert again is not None
    # The order of simultaneous actions decides their numbers of readers.
    assert Counter(each.name for each in again) == Counter(each.name for each in first.plan.actions)
