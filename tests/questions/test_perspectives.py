"""Tests of the views of affordances. Every witness is checked against classes, facts and the network."""

import networkx as nx
import pytest
from bank import problem
from scenes import rolling_task
from workshop import at, cut, workshop_task

from hybrid_tamp.errors import InputError
from hybrid_tamp.model.affordances import Affordance
from hybrid_tamp.model.predicate import SymbolSort
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.questions.affordances.perspectives import afforded_to, environment, observer, team
from hybrid_tamp.questions.affordances.what_if import change_task

TIPPING = {"TIPPING:opposite", "TIPPING:adjacent", "TIPPING:lower"}


def robots(*edits: tuple[str, str]) -> Task:
    return problem("tumble_two_robots", *edits)


def blocks(affordances: list[Affordance]) -> set[str]:
    return {each.block for each in affordances}


def check(task: Task, affordance: Affordance) -> None:
    """Check a witness independently: classes, acting agents, feasibility facts and paths along edges."""
    block = task.domain.block_by_name[affordance.block]
    bound = {role: task.value(name) for role, name in affordance.witness.items()}
    assert set(bound) == set(block.roles)
    for role, sort in block.roles.items():
        value = bound[role]
        assert value in sort.symbols if isinstance(sort, SymbolSort) else isinstance(value, Token)
        assert not isinstance(value, Token) or isinstance(sort, SymbolSort) or value.is_member(sort)
    tokens = [value for value in bound.values() if isinstance(value, Token)]
    assert len(set(tokens)) == len(tokens)
    for literal in block.entry:
        if literal.predicate.static:
            assert float(literal.margin(task.state, bound)) >= 0
    others = {t for name, own in task.agents.items() if name not in affordance.agents for t in own}
    assert not others & {token.name for token in tokens}
    for slot in block.slots:
        assert nx.has_path(task.domain.network.graph, ("RESTING", "token"), (block.name, slot.name))


def test_by_class_alone_a_box_can_be_tumbled_and_a_drum_rolled() -> None:
    assert blocks(environment(robots())) == TIPPING | {"TILTING"}
    (roll,) = environment(rolling_task(hands=0))
    assert (roll.object, roll.block, roll.slot, dict(roll.witness)) == ("drum 0", "ROLLING", "object", {})


def test_two_one_handed_robots_can_only_together() -> None:
    task = robots()
    assert afforded_to(task, "A") == afforded_to(task, "B") == []
    found = team(task)
    assert blocks(found) == TIPPING | {"TILTING"}
    assert {each.agents for each in found} == {("A", "B")}
    for each in found:
        check(task, each)


def test_what_a_member_can_alone_is_not_the_teams() -> None:
    task = robots().replaced(agents={"A": ("hand-a", "hand-b"), "B": ()})
    assert blocks(afforded_to(task, "A")) == TIPPING | {"TILTING"}
    assert team(task) == []


def test_a_robot_that_is_too_weak_is_of_no_help() -> None:
    assert team(robots(("maximal_force: 300", "maximal_force: 60"))) == []


@pytest.mark.parametrize("name", ["roll_cylinder", "tumble_two_hands", "tumble_two_boxes_four_hands"])
def test_every_witness_holds(name: str) -> None:
    task = problem(name)
    found = afforded_to(task, "robot")
    assert found
    for each in found:
        check(task, each)


def test_a_block_that_no_edge_leads_to_is_not_afforded() -> None:
    task = workshop_task((at(),), hands=(50.0,))
    assert {(a.object, a.block) for a in afforded_to(task, "robot")} == {
        ("cutter 0", "SETTING"),
        ("cutter 0", "CUTTING"),
        ("part 0", "CUTTING"),
    }
    # If nothing can be cut, blocks that are reachable only from CUTTING are also unreachable.
    blunt = workshop_task((at(),), hands=(50.0,), edges=(1.0,))
    assert {(a.object, a.block) for a in afforded_to(blunt, "robot")} == {("cutter 0", "SETTING")}


def test_who_was_seen_acting_implies_the_same_for_those_like_it() -> None:
    task = workshop_task((cut(),)).replaced(agents={"A": ("hand 0",), "B": ("hand 1",)})
    seen, implied = observer(task)
    assert {each.agents for each in seen} == {("A",), ("B",)}
    assert {(each.affordance.agents, each.observer) for each in implied} == {(("A",), "B"), (("B",), "A")}
    assert all(each.witness for each in implied)


def test_more_hands_imply_nothing_for_fewer() -> None:
    task = workshop_task((at(),), hands=(50.0, 50.0, 50.0))
    task = task.replaced(agents={"A": ("hand 0", "hand 1"), "B": ("hand 2",)})
    assert {each.observer for each in observer(task)[1]} == {"A"}


def test_like_classes_imply_but_a_weak_hand_cannot() -> None:
    task = workshop_task((at(),), hands=(50.0, 50.0, 9.0, 9.0))
    task = task.replaced(agents={"A": ("hand 0", "hand 1"), "B": ("hand 2", "hand 3")})
    carrying = [each for each in observer(task)[1] if each.affordance.block == "CARRYING" and each.observer == "B"]
    assert carrying
    assert not any(each.witness for each in carrying)


def test_one_more_hand_makes_tumbling_possible_and_one_less_takes_it_away() -> None:
    def seen(of: Task) -> list[Affordance]:
        return afforded_to(of, "robot")

    one = problem("tumble_one_hand")
    assert seen(one) == []
    assert blocks(seen(change_task(one, "+STATIC END-EFFECTOR", seen))) == TIPPING | {"TILTING"}
    assert seen(change_task(problem("tumble_two_hands"), "-hand-2", seen)) == []
    assert change_task(problem("tumble_two_hands"), "-box", seen).goal == ()


@pytest.mark.parametrize(
    ("question", "said"),
    [
        ("+STATIC END EFFECTOR", "did you mean 'STATIC END-EFFECTOR'?"),
        ("+REGION", "available: ROLLABLE, STATIC END-EFFECTOR, TUMBLABLE"),
        ("-hand-7", "did you mean 'hand-1'?"),
        ("STATIC END-EFFECTOR", "a question must begin with + or -"),
    ],
)
def test_questions_that_cannot_be_answered(question: str, said: str) -> None:
    with pytest.raises(InputError, match="questions") as raised:
        change_task(problem("tumble_one_hand"), question, environment)
    assert said in str(raised.value)


def test_one_more_of_a_class_without_members() -> None:
    task = change_task(workshop_task((cut(),), edges=()), "+CUTTER", environment)
    assert ("cutter (2)", "CUTTING") in {(each.object, each.block) for each in afforded_to(task, "robot")}
