"""Tests of the reason for each token of a plan, which is a chain of links in the plan that ends in the goal."""

import pytest
from bank import problem
from workshop import at, cut, workshop_task

import hybrid_tamp
from hybrid_tamp.model.explanation import Cause
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.explain.causal_links import find_causes, find_links


def planned(task: Task) -> TaskPlan:
    return hybrid_tamp.plan(task).required()


@pytest.fixture(scope="module")
def robots() -> tuple[Task, TaskPlan]:
    task = problem("tumble_two_robots")
    return task, planned(task)


def test_every_link_is_in_the_plan_and_leads_to_the_goal(robots: tuple[Task, TaskPlan]) -> None:
    task, plan = robots
    instances = {instance.name: instance for instance in plan.instances}
    links = find_links(task, plan)
    assert {link.needed_by for link in links} >= {None}
    for link in links:
        instance = instances[link.instance]
        bound = task.bind(instance.roles)
        block = task.domain.block_by_name[instance.block]
        assert link.atom in {literal.ground(bound) for literal in block.exit}
        if link.needed_by is None:
            assert link.atom in task.goal
        else:
            later = instances[link.needed_by]
            entry = task.domain.block_by_name[later.block].entry
            assert link.atom in {literal.ground(task.bind(later.roles)) for literal in entry}
            assert instance.start < later.start
            assert any(other.instance == link.needed_by for other in links)


def test_both_robots_and_the_box_are_needed(robots: tuple[Task, TaskPlan]) -> None:
    found = {cause.token: cause for cause in find_causes(*robots)}
    assert all(cause.used for cause in found.values())
    assert found["hand-a"].why.endswith("which achieves posture(box, flat right) for the goal")
    assert found["hand-a"].why.startswith("slot first of TIPPING-")


def test_why_others_are_not_needed() -> None:
    task = workshop_task((cut(),), hands=(50.0, 50.0), parts=((60.0, 3.0), (60.0, 3.0)))
    found: dict[str, Cause] = {cause.token: cause for cause in find_causes(task, planned(task))}
    unused = {name for name, cause in found.items() if not cause.used}
    assert len(unused & {"hand 0", "hand 1"}) == 1
    (hand,) = unused & {"hand 0", "hand 1"}
    (other,) = {"hand 0", "hand 1"} - unused
    assert found[hand].why == f"not needed: {other} already fills hand of CUTTING-1"
    why = "no block that contributes to the goal has a slot or a target that this token can fill"
    assert found["station 0"].why == why
    assert "part 1" in unused


def test_what_holds_at_the_beginning() -> None:
    task = workshop_task((at(),))
    done = task.replaced(goal=())
    assert not any(cause.used for cause in find_causes(done, planned(task)))
