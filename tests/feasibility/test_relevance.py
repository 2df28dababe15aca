"""Tests of the blocks that are relevant to a goal. Irrelevant parts of a task are never examined."""

import pytest
import serial
from exhaustive import shortest_plan
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from random_series import RandomSeries
from serial import Part, Tool, block, changing
from tools import CROWBAR, HAMMER, Ball, domain, task

from hybrid_tamp.feasibility.relevance import find_relevant_blocks, keep_relevant
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.planning.widening import Widening
from hybrid_tamp.questions.explain.no_plan import explain_wholly
from hybrid_tamp.symbolic.encoding.problem import compile_task
from hybrid_tamp.taskfile.roles import can_start

DONE, ODD = changing("done", Part), changing("odd", Part)
LONELY = changing("lonely", Tool)


def names(of: Task) -> set[str]:
    return {each.name for each in find_relevant_blocks(of)}


def chain(*edges: tuple[str, str]) -> Task:
    """Return a task that block B solves. Block A may come before B, but achieves no entry condition of B."""
    blocks = [block("A", {"part": Part}, (), [ODD("part")]), block("B", {"part": Part}, (), [DONE("part")])]
    ends = [("B.part", "RESTING.token"), ("RESTING.token", "A.part")]
    of = serial.domain(blocks, [DONE, ODD], [*ends, *edges])
    return serial.task(of, [("done", "part 0")], parts=1, tools=1)


BY_A = ("A.part", "B.part")
DIRECTLY = ("RESTING.token", "B.part")


def test_what_no_goal_asks_for_is_irrelevant() -> None:
    things = {"hammer": HAMMER, "bar": CROWBAR, "ball": [Ball]}
    whole = task(things, of=domain(3))
    assert names(whole) == {"RESTING", "GRASPING", "DRIVING", "LEVERING"}
    part = keep_relevant(whole)
    assert set(part.token_by_name) == {"hand", "nail", "hammer", "bar"}
    assert {"near-0", "moved-0", "pushed"}.isdisjoint(part.domain.predicate_by_name)


def test_the_task_itself_where_all_is_relevant() -> None:
    part = keep_relevant(task({"hammer": HAMMER}))
    assert keep_relevant(part) is part


@pytest.mark.parametrize(
    ("made", "kept"),
    [
        (chain(BY_A), {"RESTING", "A", "B"}),
        (chain(BY_A, DIRECTLY), {"RESTING", "B"}),
        (chain(DIRECTLY, ("A.part", "RESTING.token")), {"RESTING", "B"}),
    ],
    ids=["the only way", "passed by", "aside"],
)
def test_a_block_is_relevant_where_tokens_have_to_pass_through_it(made: Task, kept: set[str]) -> None:
    assert names(made) == kept


@pytest.mark.parametrize(("hold", "kept"), [(True, {"RESTING", "A", "B"}), (False, {"RESTING", "A", "B", "WAITING"})])
def test_a_block_to_wait_in_is_relevant_between_those_that_do_not_hold(hold: bool, kept: set[str]) -> None:
    waiting = block("WAITING", {"part": Part}, (), [changing("waited", Part)("part")], hold=True)
    blocks = [
        block("A", {"part": Part}, (), [ODD("part")], hold=hold),
        waiting,
        block("B", {"part": Part}, [ODD("part")], [DONE("part")]),
    ]
    ways = [("RESTING.token", "A.part"), BY_A, ("A.part", "WAITING.part"), ("WAITING.part", "B.part")]
    of = serial.domain(blocks, [DONE, ODD, waiting.exit[0].predicate], [*ways, ("B.part", "RESTING.token")])
    assert names(serial.task(of, [("done", "part 0")], parts=1, tools=1)) == kept


def test_what_starts_in_a_block_keeps_it() -> None:
    assert "A" in names(chain(BY_A, DIRECTLY).replaced(assignment={"part 0": "A"}))


def test_a_condition_on_other_things_is_not_asked_for() -> None:
    """No token can be both a place and a thing, or a member of two disjoint classes."""
    loose = block("C", {"tool": Tool}, (), [LONELY("tool")])
    of = serial.domain(
        [block("B", {"part": Part}, (), [DONE("part")]), loose],
        [DONE, LONELY],
        [DIRECTLY, ("B.part", "RESTING.token"), ("RESTING.token", "C.tool"), ("C.tool", "RESTING.token")],
    )
    assert names(serial.task(of, [("done", "part 0")], parts=1, tools=1)) == {"RESTING", "B"}


@settings(max_examples=60)
@given(st.integers(0, 10_000))
def test_no_plan_is_lost(seed: int) -> None:
    whole = RandomSeries(seed).task()
    assume(all(can_start(whole.domain.block_by_name[each]) for each in whole.assignment.values()))
    part = keep_relevant(whole)
    assume(part is not whole)
    found, expected = (shortest_plan(compile_task(each).problem) for each in (part, whole))
    assert (found is None) == (expected is None)
    assert len(found or ()) == len(expected or ())


def test_nothing_irrelevant_is_brought_in() -> None:
    whole = task({f"odd {i}": [c] for i, c in enumerate(domain(3).classes[-3:])}, of=domain(3))
    widening = Widening(whole)
    assert widening.find_outside(widening.reducer.reduce()) == []


def test_an_explanation_asks_nothing_about_what_is_irrelevant() -> None:
    of = domain(3)
    for predicate in of.predicates:
        if "-" in predicate.name:
            object.__setattr__(predicate, "margin", _never)
    odd = {f"odd {i}": [c] for i, c in enumerate(of.classes[-3:])}
    found = explain_wholly(task({"light hammer": HAMMER, **odd}, of=of), 60, most=1)
    assert [reason.atom for reason in found.reasons] == [Atom("heavy_enough", ("light hammer", "nail"))]
    assert [each.change.kind for each in found.suggestions] == ["fact"]


def _never(*_: object) -> None:
    raise AssertionError("a fact about something irrelevant was asked for")
