"""If hands tumble a box, facts about a hand that waits beside the box become false, in plans and in the law."""

from dataclasses import replace

import pytest
from hybrid_tamp_domains.rolling_tumbling.faces import over
from random_tasks.tumbling import random_tumbling

import hybrid_tamp
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.find_plan import find_plan

TASK = random_tumbling(0, hands=3)
WAITS = "hand 3"


@pytest.fixture(scope="module")
def plan() -> TaskPlan:
    """Return a lawful plan in which two hands tumble the box, and the third hand rests all the time."""
    found = hybrid_tamp.plan(random_tumbling(0)).required()
    rests = BlockInstance("RESTING-w", "RESTING", {"token": WAITS}, 0.0, found.makespan, reached=0.1)
    found = replace(found, instances=(*found.instances, rests))
    assert not check_law(TASK, found)
    return found


def occupied(plan: TaskPlan, *instances: BlockInstance) -> TaskPlan:
    """Return the plan with different instances for the waiting hand."""
    others = [i for i in plan.instances if WAITS not in i.slots.values()]
    return replace(plan, instances=(*others, *instances))


def reach(plan: TaskPlan, end: float) -> tuple[BlockInstance, BlockInstance]:
    """Return instances in which the third hand moves to the left face and stays there until a time [s]."""
    first = next(i for i in plan.instances if i.block == "REACHING:beside" and i.targets["face"] == "left")
    rest = BlockInstance("RESTING-w", "RESTING", {"token": WAITS}, 0.0, first.start, reached=first.start)
    return rest, replace(first, name="REACHING-w", slots={"hand": WAITS}, end=end)


def tipping(plan: TaskPlan, mode: str) -> BlockInstance:
    return next(i for i in plan.instances if i.block == f"TIPPING:{mode}")


def test_a_hand_cannot_stand_by_at_a_face_while_others_turn_the_box(plan: TaskPlan) -> None:
    rest, stands = reach(plan, plan.makespan)
    found = check_law(TASK, occupied(plan, rest, stands))
    assert {(v.law, v.where) for v in found} >= {(5, stands.name)}
    assert any("TIPPING" in v.message and "changes the target box 1 of" in v.message for v in found)


def test_what_a_hand_knew_of_a_box_is_gone_once_it_steps_aside(plan: TaskPlan) -> None:
    tips = tipping(plan, "opposite")
    rest, stands = reach(plan, tips.start)
    aside = BlockInstance("RESTING-x", "RESTING", {"token": WAITS}, tips.start, plan.makespan, reached=tips.start + 0.1)
    assert not check_law(TASK, occupied(plan, rest, stands, aside))
    # The hand was at the left face before the box turned, so it cannot take part in the tumble afterwards.
    lowers = tipping(plan, "lower")
    aside = replace(aside, end=lowers.start)
    joins = replace(lowers, slots={**lowers.slots, "first": WAITS}, targets={**lowers.targets, "near": "left"})
    instances = tuple(i for i in plan.instances if i.name != lowers.name and WAITS not in i.slots.values())
    found = check_law(TASK, replace(plan, instances=(*instances, rest, stands, aside, joins)))
    assert any(v.law == 5 and "at_face(hand 3, box 1, left) does not hold" in v.message for v in found)


def test_plans_reach_a_face_anew_after_others_have_turned_the_box() -> None:
    tipped = over("bottom", "right")
    at_left = [Atom("at_face", (hand, "box 1", "left")) for hand in ("hand 1", WAITS)]
    task: Task = TASK.replaced(goal=(Atom("posture", ("box 1", tipped)), *at_left))
    with PlannerProcess() as planner:  # Both hands need the same place, so `plan` would refuse the task.
        found = find_plan(task, planner).plan
    assert found is not None
    tips = tipping(found, "opposite")
    # One of the two hands tips the box from there. The third hand could have been there before, but not any more.
    [other] = {"hand 1", WAITS} - set(tips.slots.values())
    *_, (last, _) = found.timeline(other)
    assert (last.block, last.targets["posture"]) == ("REACHING:beside", tipped)
    assert tips.reached is not None
    assert last.start >= tips.reached - 1e-6
