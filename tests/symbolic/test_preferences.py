"""Preferences of blocks shape a plan if possible, and are ignored if there is no such plan."""

from collections.abc import Iterator
from pathlib import Path

import pytest

import hybrid_tamp
from hybrid_tamp.model.deadline import Deadline
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.find_plan import find_plan
from hybrid_tamp.symbolic.preferences import prefer
from hybrid_tamp.symbolic.strategies.search import Planner

PROBLEMS = Path("problems")


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    with PlannerProcess() as process:
        yield process


def load(name: str, *changes: tuple[str, str], folder: Path) -> Task:
    text = (PROBLEMS / f"{name}.yaml").read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path = folder / "task.yaml"
    path.write_text(text, encoding="utf-8")
    return hybrid_tamp.load_task(path)


def solved(task: Task, planner: Planner) -> TaskPlan:
    result = find_plan(task, planner, Deadline.after(60.0))
    assert result.plan is not None
    assert check_law(task, result.plan) == []
    return result.plan


def changes_of_side(task: Task, plan: TaskPlan) -> list[str]:
    """Return the instances that break the preference of their block."""
    return [
        each.name
        for each in plan.instances
        for literal in task.domain.block_by_name[each.block].preferences
        if literal.margin(task.state, task.bind(each.roles)) < 0
    ]


def test_a_preference_is_an_entry_condition_of_the_first_search_only() -> None:
    task = hybrid_tamp.load_task("tumble_two_hands")
    preferred = prefer(task)
    assert preferred is not None
    for block in task.domain.blocks:
        wanted = (*block.entry, *block.preferences)
        assert preferred.domain.block_by_name[block.name].entry == wanted
    assert prefer(hybrid_tamp.load_task("lift_two_hands")) is None


def test_hands_stay_on_their_sides_if_they_can(planner: Planner, tmp_path: Path) -> None:
    task = load("tumble_two_hands", folder=tmp_path)
    assert changes_of_side(task, solved(task, planner)) == []


def test_a_hand_changes_sides_if_both_start_on_one_side(planner: Planner, tmp_path: Path) -> None:
    task = load("tumble_two_hands", ("[0.5, 0, 0.55]", "[-0.75, 0.1, 0.55]"), folder=tmp_path)
    plan = solved(task, planner)
    assert len(plan.actions) == 17
    assert changes_of_side(task, plan)


def test_hands_change_sides_if_a_box_has_to_wait(planner: Planner, tmp_path: Path) -> None:
    """Three hands tumble two boxes, so a hand serves both boxes."""
    text = (PROBLEMS / "tumble_two_boxes_four_hands.yaml").read_text(encoding="utf-8")
    first, last = text.index("  hand-2:"), text.index("  hand-3:")
    task = load("tumble_two_boxes_four_hands", (text[first:last], ""), ("hand-2, ", ""), folder=tmp_path)
    assert changes_of_side(task, solved(task, planner))
