"""A forbidden binding is not used again. All other bindings remain possible."""

from collections.abc import Callable
from itertools import pairwise, permutations

import pytest
from random_tasks.lifting import random_lifting
from random_tasks.tumbling import random_tumbling
from scenes import rolling_task
from serial import COLOURS, Part, block, changing, domain, in_series, task

import hybrid_tamp
from hybrid_tamp.errors import InputError
from hybrid_tamp.model import forbidding
from hybrid_tamp.model.block import Block
from hybrid_tamp.model.forbidding import deciding_roles, forbid, forbidden_bindings
from hybrid_tamp.model.law import check_law
from hybrid_tamp.model.plan import BlockInstance, TaskPlan
from hybrid_tamp.model.predicate import ANY, Atom, Parameter, Predicate
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.changes import with_copy


def used(plan: TaskPlan, action: str) -> BlockInstance:
    return next(instance for instance in plan.instances if instance.action == action)


def solved(given: Task) -> TaskPlan:
    return hybrid_tamp.plan(given).required()


def test_the_other_hand_is_found_and_then_no_other_is() -> None:
    given = rolling_task(hands=2)
    first = solved(given)
    once = forbid(given, used(first, "ROLLING"))
    second = solved(once)
    assert {used(first, "ROLLING").slots["hand"], used(second, "ROLLING").slots["hand"]} == {"hand 0", "hand 1"}
    assert check_law(given, second) == []
    assert any("permitted_ROLLING" in str(each) and each.law == 5 for each in check_law(once, first))
    outcome = hybrid_tamp.plan(forbid(once, used(second, "ROLLING")))
    assert outcome.status == "unsolvable"
    assert "ROLLING of drum 0 by hand " in str(outcome.error)
    assert "to region 0 failed in the forward models" in str(outcome.error)


def test_the_other_region_is_found_where_the_goal_leaves_a_choice() -> None:
    given = rolling_task(regions=[(0.6, 0), (0.9, 0)]).replaced(goal=(Atom("inside", ("drum 0", ANY)),))
    once = forbid(given, used(solved(given), "ROLLING"))
    assert used(solved(once), "ROLLING").targets == {"region": "region 1"}
    assert once.goal == given.goal


def test_several_bindings_of_a_block_are_one_predicate() -> None:
    given = rolling_task(hands=2)
    instances = [
        BlockInstance("ROLLING-1", "ROLLING", {"hand": hand, "object": "drum 0"}, 0, 1, {"region": "region 0"})
        for hand in ("hand 0", "hand 1")
    ]
    for instance in (*instances, instances[0]):
        given = forbid(given, instance)
    assert forbidden_bindings(given, "ROLLING") == {(hand, "drum 0", "region 0") for hand in ("hand 0", "hand 1")}
    before = rolling_task().domain
    assert len(given.domain.predicates) == len(before.predicates) + 1
    assert len(given.domain.block_by_name["ROLLING"].entry) == len(before.block_by_name["ROLLING"].entry) + 1
    margin = given.domain.predicate_by_name["permitted_ROLLING"].evaluate(
        given.state.repeated(3), "hand 0", "drum 0", "x"
    )
    assert margin.tolist() == [1.0, 1.0, 1.0]


def test_goals_planned_apart_leave_the_forbidden_binding_out() -> None:
    given = rolling_task(2, [(0.0, 0.0), (0.0, 0.6)], [(0.7, 0.0), (0.7, 0.6)], [(0, 0), (1, 1)])
    rolls = [(i.slots["hand"], i.slots["object"]) for i in solved(given).instances if i.action == "ROLLING"]
    bad = used(solved(given), "ROLLING")
    again = [
        (i.slots["hand"], i.slots["object"]) for i in solved(forbid(given, bad)).instances if i.action == "ROLLING"
    ]
    assert (bad.slots["hand"], bad.slots["object"]) in rolls
    assert (bad.slots["hand"], bad.slots["object"]) not in again
    assert len(again) == 2


def test_only_the_mode_is_forbidden_and_the_box_is_turned_in_another_way() -> None:
    given = random_tumbling(7)
    bad = used(solved(given), "TIPPING")
    again = forbid(given, bad)
    other = solved(again)
    assert all((i.block, i.roles) != (bad.block, bad.roles) for i in other.instances)
    assert check_law(given, other) == []
    changed = [b.name for b in again.domain.blocks if b is not given.domain.block_by_name[b.name]]
    assert changed == [bad.block]


def test_of_a_block_with_many_slots_those_who_are_in_them_count() -> None:
    """The condition is checked at the last slot, for the tokens that are in the other slots at that time."""
    given = random_lifting(0, hands=4)
    plan = solved(given)
    other = solved(forbid(given, used(plan, "LIFTING")))
    assert used(other, "LIFTING").slots != used(plan, "LIFTING").slots
    first = given.token_by_name["hand 1"]
    fifth = with_copy(given, first, given.state[first, "position"] + [-0.3, 0.0, 0.0])
    other = solved(forbid(fifth, used(solved(fifth), "LIFTING")))
    assert used(other, "LIFTING").slots != used(solved(fifth), "LIFTING").slots
    assert check_law(fifth, other) == []


def test_symbols_that_follow_from_others_are_left_out() -> None:
    def painting(holds: Callable[[str, str], bool]) -> Block:
        parameters = Parameter("old", COLOURS), Parameter("new", COLOURS)
        rows = [row for row in permutations(COLOURS.symbols, 2) if holds(*row)]
        pairs = Predicate.relation("pairs", parameters, rows)
        return block("PAINT", {"part": Part}, [pairs("old", "new")], targets={"old": COLOURS, "new": COLOURS})

    cycle = dict(pairwise((*COLOURS.symbols, COLOURS.symbols[0])))
    assert deciding_roles(painting(lambda old, new: cycle[old] == new)) == ("part", "old")
    assert deciding_roles(painting(lambda old, new: old != new)) == ("part", "old", "new")
    tipping = random_tumbling(3).domain.block_by_name["TIPPING:lower"]
    assert deciding_roles(tipping) == ("first", "second", "object", "near", "before")


def test_too_many_facts_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    painted = changing("painted", Part, COLOURS)
    paint = block("PAINT", {"part": Part}, [], [painted("part", "new")], {"new": COLOURS})
    given = task(domain([paint], [painted], in_series([paint])), [("painted", "part 0", "red")], parts=2)
    instance = BlockInstance("PAINT-1", "PAINT", {"part": "part 0"}, 0, 1, {"new": "red"})
    assert forbidden_bindings(forbid(given, instance), "PAINT") == {("part 0", "red")}
    monkeypatch.setattr(forbidding, "MOST_FACTS", 5)
    with pytest.raises(InputError, match=r"PAINT: .* must have at most 5 bindings; got 6"):
        forbid(given, instance)
