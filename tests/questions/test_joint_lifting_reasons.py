"""Tests of affordances of groups, and of messages about loads that are too heavy: each message is true."""

import pytest
from bank import problem

import hybrid_tamp
from hybrid_tamp.model.explanation import Reason
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.affordances.perspectives import afforded_to, environment, team
from hybrid_tamp.questions.changes import with_copy
from hybrid_tamp.questions.explain.no_plan import explain

FOUR = {"LIFTING:four", "HOLDING:four", "LOWERING:four"}
TWO = {"LIFTING:two", "HOLDING:two", "LOWERING:two"}


def crate(mass: float, hands: str = "two") -> Task:
    """Return the task with a crate of the given mass, for two or for four hands."""
    name = "lift_heavy_two_hands" if hands == "two" else "lift_four_hands"
    return problem(name, ("mass: 24", f"mass: {mass}"))


def reasons(task: Task) -> dict[str, Reason]:
    return {f"{reason.block} {reason.kind}": reason for reason in explain(task)}


def test_two_robots_lift_what_neither_can() -> None:
    task = crate(24, "four")
    assert {each.block for each in environment(task)} == TWO | FOUR
    assert afforded_to(task, "A") == afforded_to(task, "B") == []
    found = team(task)
    assert {each.block for each in found} == FOUR
    assert {(each.agents, each.object) for each in found} == {(("A", "B"), "crate")}
    filled = [{token: slot for slot, token in each.witness.items()} for each in found]
    assert all(set(each) == {"a-left", "b-left", "a-right", "b-right", "crate"} for each in filled)


def test_a_light_crate_each_robot_lifts_alone() -> None:
    for name in ("A", "B"):
        assert {each.block for each in afforded_to(crate(12, "four"), name)} == TWO
    assert {each.block for each in team(crate(12, "four"))} == FOUR


def test_a_weak_robot_is_of_no_help() -> None:
    weak = problem("lift_four_hands", ("maximal_force: 300", "maximal_force: 150"))
    assert team(weak) == []


def test_too_heavy_for_two_and_two_more_would_do() -> None:
    found = reasons(crate(24))
    assert set(found) == {"LIFTING:two not_feasible", "LIFTING:four too_few_tokens"}
    heavy, few = found["LIFTING:two not_feasible"], found["LIFTING:four too_few_tokens"]
    assert heavy.atom == Atom("bears", ("right-hand", "crate", "two hands"))
    assert heavy.margin == pytest.approx(-40.42, abs=0.01)
    assert "each of 2 tokens must bear 117.7 N (235.4 N in total)" in heavy.message
    assert "the tokens can bear 77.3 N (left-hand), 77.3 N (right-hand) and 154.6 N in total" in heavy.message
    assert heavy.message.endswith("4 tokens like right-hand could bear the load, 2 for each share")
    assert "needs 4 tokens of class STATIC END-EFFECTOR" in few.message
    assert few.message.endswith("but the task has 2; 2 more tokens like the present ones would be enough")


def test_one_more_hand_is_not_suggested_and_would_not_do_but_two_do() -> None:
    task = crate(24)
    outcome = hybrid_tamp.plan(task, trials=60)
    assert outcome.status == "unsolvable"
    assert outcome.explanation is not None
    said = outcome.explanation.suggestions
    assert said
    assert not any("hand" in each.change.what for each in said)
    left, right = task.token_by_name["left-hand"], task.token_by_name["right-hand"]
    one = with_copy(task, left, task.state[left, "position"] + [0.0, 0.3, 0.0])
    assert hybrid_tamp.plan(one, trials=0).status == "unsolvable"
    two = with_copy(one, right, task.state[right, "position"] + [0.0, 0.3, 0.0])
    assert hybrid_tamp.plan(two).status == "solved"


def test_too_heavy_for_four_and_more_hands_would_not_do() -> None:
    found = reasons(crate(40))
    few, heavy = found["LIFTING:four too_few_tokens"], found["LIFTING:four not_feasible"]
    assert few.message.endswith("the task has 2; 2 more tokens like the present ones would not be enough")
    assert "each of 4 tokens must bear 98.1 N" in heavy.message
    assert heavy.message.endswith("but no block of joint_lifting uses more than 4 of them")
    assert "no block of joint_lifting uses more than 4 of them" in found["LIFTING:two not_feasible"].message
    four = reasons(crate(40, "four"))
    assert set(four) == {"LIFTING:two not_feasible", "LIFTING:four not_feasible"}
    assert "309.2 N in total" in four["LIFTING:four not_feasible"].message


def test_a_narrow_crate_has_no_room_for_two_hands_side_by_side() -> None:
    found = explain(problem("lift_four_hands", ("[0.2, 0.25, 0.15]", "[0.2, 0.08, 0.15]")))
    narrow = [reason for reason in found if reason.block == "LIFTING:four"]
    assert narrow
    assert all("does not fit at the" in reason.message for reason in narrow)
    assert [reason.margin for reason in narrow] == pytest.approx([0.08 - 0.02 - 0.07] * len(narrow))
