"""Each reason is true, and removing its cause makes the task solvable."""

from scenes import rolling_task

import hybrid_tamp
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.questions.explain.no_plan import explain


def test_a_region_off_the_rolling_line() -> None:
    (reason,) = explain(rolling_task(regions=[(0.7, 0.1)]))
    assert (reason.kind, reason.block, reason.atom) == (
        "not_feasible",
        "ROLLING",
        Atom("on_rolling_line", ("drum 0", "region 0")),
    )
    assert reason.margin is not None
    assert abs(reason.margin + 0.078) < 1e-9
    assert "off by 0.078 m" in reason.message


def test_no_hand() -> None:
    (reason,) = explain(rolling_task(hands=0))
    assert reason.kind == "no_token"
    assert "slot hand of ROLLING" in reason.message
    assert "1 more token would be enough" in reason.message


def test_the_best_hand_counts_where_none_reaches() -> None:
    (reason,) = explain(rolling_task(hands=2, regions=[(3.0, 0.0)]))
    assert reason.atom is not None
    assert reason.atom.predicate == "within_workspace"
    assert reason.unit == "m"


def test_nothing_is_wrong_with_a_solvable_task() -> None:
    assert explain(rolling_task()) == []


def test_a_goal_that_no_block_brings_about() -> None:
    (reason,) = explain(rolling_task().replaced(goal=(Atom("lies_on_side", ("region 0",)),)))
    assert reason.kind == "no_block"


def test_what_is_explained_is_unsolvable_and_its_repair_is_not() -> None:
    assert hybrid_tamp.plan(rolling_task(hands=0)).status == "unsolvable"
    assert hybrid_tamp.plan(rolling_task(hands=1)).status == "solved"
