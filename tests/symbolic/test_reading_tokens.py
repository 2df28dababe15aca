"""Hands that read an object may enter the block that changes it, because their old blocks end at that instant."""

from itertools import permutations
from typing import Any

import crates
import pytest

import hybrid_tamp
from hybrid_tamp.authoring import Slot
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import TaskPlan
from hybrid_tamp.model.task import Task
from hybrid_tamp.symbolic.encoding.encoder import encode_task
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.symbolic.engines.planner_process import PlannerProcess
from hybrid_tamp.symbolic.find_plan import find_plan
from hybrid_tamp.symbolic.reencode import reencode


def find(task: Task) -> TaskPlan:
    """Return a plan whose movements are not compared, because both hands go to the same place behind the crate."""
    with PlannerProcess() as planner:
        found = find_plan(task, planner).plan
    assert found is not None
    assert not check_law(task, found)
    return found


EDGES = (("REACHING.hand", "PUSHING.helper"), ("PUSHING.helper", "RESTING.token"))


def push_together(order: tuple[str, ...]) -> Any:
    """Return a change of PUSHING, in which two hands push the crate. The order is that of the slots."""

    def change(on: crates.Named) -> dict[str, Any]:
        block = next(each for each in crates.make_blocks(on) if each.name == "PUSHING")
        slots = {"helper": Slot("helper", crates.Hand), **{slot.name: slot for slot in block.slots}}
        return {
            "slots": tuple(slots[name] for name in order),
            "entry": (*block.entry, on["behind"]("helper", "crate", "dock")),
        }

    return change


def test_the_anchor_may_read_the_object_that_its_next_block_changes() -> None:
    task = crates.make_task()
    found = hybrid_tamp.plan(task)
    assert found.plan is not None
    assert not check_law(task, found.plan)
    names = [each.name for each in encode_task(task).planning.operators if each.name.startswith("begin-pushing")]
    assert names == ["begin-pushing-from-reaching", "begin-pushing-from-reaching-crate-was-crate"]


@pytest.mark.parametrize("order", list(permutations(("hand", "helper", "crate"))))
def test_two_hands_may_read_the_object_that_they_push(order: tuple[str, ...]) -> None:
    task = crates.make_task({"PUSHING": push_together(order)}, edges=EDGES, hands=("hand", "helper"))
    compilation = compile_task(task)
    assert compilation.reaches_goal(reencode(compilation, find(task)))


def test_a_hand_that_is_not_in_the_block_may_not_read_the_object() -> None:
    task = crates.make_task(hands=("hand", "helper"), goal=[{"behind": ["helper", "crate", "far"]}])
    plan = find(task)
    (push,) = (each for each in plan.instances if each.block == "PUSHING")
    (other,) = (each for each in plan.instances if "helper" in each.slots.values() and each.block == "REACHING")
    assert other.start >= push.end or other.end <= push.start


def test_a_hand_that_cannot_be_where_another_hand_stays_is_refused() -> None:
    task = crates.make_task(hands=("hand", "helper"), goal=[{"behind": ["helper", "crate", "far"]}])
    found = hybrid_tamp.plan(task)
    assert found.plan is None
    assert "helper hits hand" in str(found.error)
