"""The reason is an atom of the initial state if the blocks that achieve the atom need the atom themselves."""

from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from bank import problem
from brute_force import solvable
from scenes import rolling_task
from workshop import WORKSHOP, Hand, _at_first, _block

from hybrid_tamp.model.affordance import AffordanceClass
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.network import ReassignmentNetwork
from hybrid_tamp.model.predicate import Atom, Parameter, Predicate
from hybrid_tamp.model.state import State
from hybrid_tamp.model.task import Task
from hybrid_tamp.model.token import Token
from hybrid_tamp.questions.explain.no_plan import explain, explain_wholly


class Tool(AffordanceClass):
    """A tool that a hand grasps."""

    name: ClassVar[str] = "TOOL"


TOOL, HAND = Parameter("tool", Tool), Parameter("hand", Hand)


def predicate(name: str, *parameters: Parameter, margin: float = -1.0) -> Predicate:
    return Predicate(name, parameters, _at_first(margin), unit="m")


STANDS, HELD, USED = predicate("stands", TOOL), predicate("held", TOOL, HAND), predicate("used", TOOL)
CHARGED = predicate("charged", TOOL)
SLOTS = {"hand": Hand, "tool": Tool}
HOLDS = (HELD("tool", "hand"),)
BLOCKS = (
    WORKSHOP.block_by_name["RESTING"],
    _block("GRASPING", SLOTS, "hand", (STANDS("tool"),), (*HOLDS, ~STANDS("tool")), hold=True),
    _block("PLACING", SLOTS, "hand", HOLDS, (STANDS("tool"), ~HELD("tool", "hand"))),
    _block("USING", SLOTS, "hand", HOLDS, (USED("tool"), *HOLDS), hold=True),
)


USE = Atom("used", ("tool",))


def tool_task(stands: float, *goal: Atom, charged: bool = False, upright: bool = False) -> Task:
    """Return a task in which a hand uses a tool. `stands` is the initial margin of ``stands`` in metres."""
    standing = predicate("stands", TOOL, margin=stands)
    change = {STANDS: standing}
    blocks = [
        replace(
            b,
            entry=tuple(replace(x, predicate=change.get(x.predicate, x.predicate)) for x in b.entry)
            + ((CHARGED("tool"),) if charged and b.name == "USING" else ())
            + ((standing("tool"),) if upright and b.name == "USING" else ()),
            exit=tuple(replace(x, predicate=change.get(x.predicate, x.predicate)) for x in b.exit),
        )
        for b in BLOCKS
    ]
    edges = [
        (f"{one}.{slot if one != 'RESTING' else 'token'}", f"{other}.{slot if other != 'RESTING' else 'token'}")
        for slot in SLOTS
        for one in ("RESTING", "GRASPING", "PLACING", "USING")
        for other in ("RESTING", "GRASPING", "PLACING", "USING")
        if one != other
    ]
    domain = Domain("tools", (Hand, Tool), (standing, HELD, USED, CHARGED), tuple(blocks), ReassignmentNetwork(edges))
    tokens = (Token.make("hand", [Hand], {"force": 1.0}), Token.make("tool", [Tool], {}))
    return Task("tools", domain, tokens, State.of(tokens, {}), goal or (USE,), {"robot": ("hand",)})


def test_a_lying_tool_that_only_the_hand_that_holds_it_can_set_up() -> None:
    assert explain(tool_task(0.0)) == []
    assert solvable(tool_task(0.0))
    task = tool_task(-0.5)
    assert not solvable(task)
    (reason,) = explain(task, proven=True)
    assert (reason.kind, reason.atom, reason.margin) == ("unreachable", Atom("stands", ("tool",)), -0.5)
    assert reason.goal == task.goal
    assert reason.message == (
        "not stands(tool) (off by 0.5 m), and no plan can achieve stands(tool) first: PLACING, which achieves "
        "stands(tool), needs held(tool, hand); GRASPING, which achieves held(tool, hand), needs stands(tool)"
    )


def test_a_goal_that_needs_itself_has_the_atom_before_it_as_the_reason() -> None:
    (reason,) = explain(tool_task(-0.5, Atom("stands", ("tool",))), proven=True)
    assert reason.atom == Atom("held", ("tool", "hand"))
    assert "GRASPING, which achieves held(tool, hand), needs stands(tool)" in reason.message


def test_a_precondition_that_no_block_achieves_is_named() -> None:
    task = tool_task(0.0, charged=True)
    assert not solvable(task)
    (reason,) = explain(task, proven=True)
    assert (reason.kind, reason.atom) == ("unreachable", Atom("charged", ("tool",)))
    assert reason.message == "not charged(tool) (off by 1 m), and no block of tools has charged as an effect"


def test_a_goal_atom_that_has_no_plan_alone_is_singled_out() -> None:
    held = Atom("held", ("tool", "hand"))
    task = tool_task(0.0, USE, held, upright=True)
    assert solvable(task.replaced(goal=(held,)))
    assert not solvable(task.replaced(goal=(USE,)))
    assert [reason.goal for reason in explain(task, proven=True)] == [(USE, held)]
    (reason,) = explain_wholly(task, 20, most=1).reasons
    assert (reason.kind, reason.goal) == ("together", (USE,))
    assert reason.message.endswith("but no plan achieves used(tool), even without the other goal atoms")
    stands = Atom("stands", ("tool",))
    (reason,) = explain_wholly(tool_task(0.0, held, stands), 20, most=1).reasons
    assert reason.goal == (held, stands), "stands holds initially, and held alone has a plan"
    assert reason.message.endswith("but no plan achieves all goal atoms together")


def test_no_change_of_a_fact_is_suggested_for_an_atom_of_the_initial_state() -> None:
    found = explain_wholly(tool_task(-0.5), 5, most=3)
    assert [reason.kind for reason in found.reasons] == ["unreachable"]
    assert all(suggestion.kind not in ("fact", "property") for suggestion in found.suggestions)


@pytest.mark.parametrize("name", ["hammer_strike", "hammer_push"])
def test_a_lying_hammer_does_not_stand(name: str) -> None:
    upright = "pose: {position: [-0.25, 0, 0.04], rpy: [0, 1.5707963267948966, 0]}"
    task = problem(name, (upright, "pose: {position: [-0.25, 0, 0.046]}"))
    reasons = explain(task, proven=True)
    assert {reason.atom for reason in reasons} == {Atom("stands", ("hammer",))}
    assert all("hammer does not stand on its head" in reason.message for reason in reasons)


def test_a_rolling_drum_is_named() -> None:
    task = rolling_task()
    moving = task.state.replace({("drum 0", "velocity"): np.array([0.0, 0.3, 0.0])})
    (reason,) = explain(task.replaced(state=moving), proven=True)
    assert reason.atom == Atom("at_rest", ("drum 0",))
