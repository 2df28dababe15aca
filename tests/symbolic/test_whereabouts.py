"""Tests of whereabouts: chains of movements are planned, and only upper bounds prove that no plan exists."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_tasks.chains import push_push, tumble_tumble

import hybrid_tamp
from hybrid_tamp.model.forbidding import forbid
from hybrid_tamp.model.margins import bound_margin
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Predicate
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.estimates import Estimates
from hybrid_tamp.symbolic.whereabouts.export import needs_whereabouts
from hybrid_tamp.symbolic.whereabouts.predicted import find_broken_conditions, predict_states
from hybrid_tamp.symbolic.whereabouts.situate import Situation
from hybrid_tamp.symbolic.whereabouts.tracking import Tracking
from hybrid_tamp.verbs.pddl import pddl


@pytest.fixture(scope="module")
def corner() -> Task:
    """Return a task in which a block is pushed round a corner, which is the region `middle`."""
    return push_push(11)


@pytest.fixture(scope="module")
def plan(corner: Task) -> TaskPlan:
    """Return a plan that pushes the block round the corner."""
    return hybrid_tamp.plan(corner).required()


def pushes(plan: TaskPlan) -> list[BlockInstance]:
    return [instance for instance in plan.instances if instance.block == "PUSHING"]


def turn_last_leg(task: Task, degrees: float) -> Task:
    """Return the task with the goal rotated about the corner, so that the last push is oblique to the block's sides."""
    middle, goal = task.state["middle", "position"], task.state["goal", "position"]
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turned = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ (goal - middle)
    return task.replaced(state=task.state.replace({("goal", "position"): middle + turned}))


def test_a_block_is_pushed_round_a_corner(plan: TaskPlan) -> None:
    assert [push.targets["region"] for push in pushes(plan)] == ["middle", "goal"]
    # The targets for whereabouts belong to the planning problem only.
    assert all(set(push.targets) == {"region"} for push in pushes(plan))


def test_a_box_is_tumbled_about_two_axes() -> None:
    outcome = hybrid_tamp.plan(tumble_tumble(2))
    assert outcome.status == "solved"
    assert len([i for i in outcome.required().instances if i.block == "TIPPING:lower"]) == 2


def test_what_fails_at_the_centre_of_a_region_only_is_no_proof(corner: Task) -> None:
    outcome = hybrid_tamp.plan(turn_last_leg(corner, 6.0), trials=0)
    assert (outcome.status, outcome.failure and outcome.failure.kind) == ("unknown", "not_found")


def test_what_fails_everywhere_in_a_region_is_a_proof(corner: Task) -> None:
    assert hybrid_tamp.plan(turn_last_leg(corner, 30.0), trials=0).status == "unsolvable"


def test_conditions_are_measured_in_predicted_states(corner: Task, plan: TaskPlan) -> None:
    assert not list(find_broken_conditions(corner, plan, Estimates(corner)))
    turned = turn_last_leg(corner, 30.0)
    broken = list(find_broken_conditions(turned, plan, Estimates(turned)))
    assert {each.atom.text for each in broken} == {"square_to(block, goal)"}
    assert broken[0].margin == pytest.approx(np.radians(5.0 - 30.0), abs=0.02)


def test_a_failed_binding_is_excluded_in_its_situation_only(corner: Task, plan: TaskPlan) -> None:
    last = pushes(plan)[-1]
    roles = Tracking(corner.domain).roles(corner.domain.block_by_name["PUSHING"])
    # The binding failed when the block was at its initial place, so the binding is still permitted at the corner.
    at_start = forbid(corner, last, corner.state, roles)
    assert [push.targets["region"] for push in pushes(hybrid_tamp.plan(at_start).required())] == ["middle", "goal"]
    there = forbid(corner, last, predict_states(corner, plan)[last.name], roles)
    assert hybrid_tamp.plan(there, trials=0).status != "solved"


def test_exported_problems_have_whereabouts_where_plans_need_them(corner: Task, tmp_path: Path) -> None:
    assert needs_whereabouts(corner)
    domain, problem, lines = pddl(corner, tmp_path, solve=True)
    assert "whereabouts" in domain.read_text()
    assert "block-in-middle" in problem.read_text()
    again = hybrid_tamp.read_plan(corner, lines)
    assert [push.targets["region"] for push in pushes(again)] == ["middle", "goal"]
    assert not needs_whereabouts(hybrid_tamp.load_task("hammer_push"))


def test_optimistic_facts_include_the_facts_at_the_expected_ends(corner: Task) -> None:
    situation = Situation(corner)

    def rows(optimistic: bool) -> dict[str, frozenset[tuple[str, ...]]]:
        predicates = situation.situated_task(optimistic).domain.static_predicates
        return {each.name: frozenset(each.rows) for each in predicates if each.rows is not None}

    likely, possible = rows(False), rows(True)
    assert likely.keys() == possible.keys()
    assert all(likely[name] <= possible[name] for name in likely)
    assert any(likely[name] < possible[name] for name in likely)


@settings(max_examples=60, deadline=None)
@given(
    radius=st.floats(0.0, 0.3),
    angle=st.floats(0.0, 2 * np.pi),
    part=st.floats(0.0, 1.0),
    name=st.sampled_from(["square_to", "push_within_reach"]),
)
def test_no_displacement_exceeds_a_bound(radius: float, angle: float, part: float, name: str) -> None:
    task = push_push(11)
    predicate: Predicate = task.domain.predicate_by_name[name]
    names = {"square_to": ("block", "goal"), "push_within_reach": ("hand", "hammer", "block", "goal")}[name]
    values = tuple(map(task.value, names))
    shift = radius * part * np.array([np.cos(angle), np.sin(angle), 0.0])
    displaced = task.state.replace({("block", "position"): task.state["block", "position"] + shift})
    assert float(predicate.evaluate(displaced, *values)) <= bound_margin(predicate, task.state, radius, values) + 1e-9
