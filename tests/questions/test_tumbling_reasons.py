"""Feasibility facts decide whether hands can tip a box, and the explanation states what is missing, with figures."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hybrid_tamp_domains.rolling_tumbling.edges import strength_needed
from hybrid_tamp_domains.rolling_tumbling.sliding import friction_needed
from hybrid_tamp_domains.rolling_tumbling.tumbling_geometry import GRIP
from hypothesis import given, settings
from hypothesis import strategies as st
from texts import load_task_text

import hybrid_tamp
from hybrid_tamp.authoring import GRAVITY
from hybrid_tamp.feasibility.safety_figures import find_blocked
from hybrid_tamp.model.explanation import Reason
from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.task import Task
from hybrid_tamp.questions.explain.no_plan import explain

PROBLEMS = Path(__file__).parents[2] / "problems"
AXIS = 1
"""Index of the body axis of the box about which hands whose axes are along y turn the box."""
ALONG_Y = "rpy: [1.5707963267948966, 0, 0]"
FORCE = "maximal_force: 300"


def task(name: str, *edits: tuple[str, str], once: bool = False) -> Task:
    text = (PROBLEMS / f"{name}.yaml").read_text(encoding="utf-8")
    for old, new in edits:
        assert old in text
        text = text.replace(old, new, 1) if once else text.replace(old, new)
    return load_task_text(text, name)


def only(reasons: list[Reason]) -> Reason:
    (reason,) = reasons
    return reason


@pytest.mark.parametrize(
    "name", ["tumble_two_hands", "tumble_left", "tumble_twice", "tumble_four_hands", "tumble_two_boxes_four_hands"]
)
def test_what_can_be_done_has_no_reason(name: str) -> None:
    assert explain(task(name)) == []


def test_one_hand_too_few() -> None:
    reason = only(explain(task("tumble_one_hand")))
    assert (reason.kind, reason.block) == ("too_few_tokens", "TIPPING:lower")
    assert "no token can fill slot second of TIPPING:lower" in reason.message
    assert "END-EFFECTOR, but the task has 1; 1 more token like the present one would be enough" in reason.message


def test_too_smooth_and_the_figure_is_the_friction_that_is_missing() -> None:
    smooth = task("tumble_two_hands", ("friction: 0.6", "friction: 0.1"))
    reason = only(explain(smooth))
    box = smooth.token_by_name["box"]
    width, height = 2.0 * max(box["half_extents"]), 2.0 * GRIP * min(box["half_extents"][0::2])
    needed = friction_needed(GRAVITY * box["mass"], width, height, 300.0)
    assert reason.atom == Atom("rough_enough", ("hand-2", "box"))
    assert reason.margin == pytest.approx(0.1 - needed)
    assert "box is too smooth: its edge slides on the floor" in reason.message


@pytest.mark.parametrize("name", ["tumble_two_hands", "tumble_four_hands"])
def test_too_heavy_for_two_and_no_block_takes_more(name: str) -> None:
    heavy = task(name, ("mass: 14", "mass: 60"))
    reason = only(explain(heavy))
    needed = strength_needed(heavy.token_by_name["box"], AXIS)
    assert reason.atom == Atom("strong_enough", ("hand-2", "box"))
    assert reason.unit == "N"
    assert reason.margin == pytest.approx(300.0 / 1.6 - needed)
    assert f"each of 2 tokens must bear {needed:.4g} N ({2 * needed:.4g} N in total)" in reason.message
    assert "187.5 N (hand-1), 187.5 N (hand-2) and 375 N in total with safety factor 1.6, 600 N w" in reason.message
    assert "box is too heavy to be tumbled by hand-2 and a second hand" in reason.message
    assert ("the best 2 of 4 tokens can bear" in reason.message) == (name == "tumble_four_hands")
    assert "4 tokens like hand-2 could bear the load, 2 for each share" in reason.message
    assert "no block of rolling_tumbling uses more than 2 of them" in reason.message


def test_one_strong_hand_does_not_make_up_for_a_weak_one() -> None:
    reason = only(explain(task("tumble_two_hands", (FORCE, "maximal_force: 60"), once=True)))
    assert reason.atom == Atom("strong_enough", ("hand-1", "box"))
    assert "2 tokens must meet this condition, but only hand-2 does" in reason.message
    assert "in total" not in reason.message


def test_the_strongest_two_of_four_count() -> None:
    weak = (FORCE, "maximal_force: 60")
    assert explain(task("tumble_four_hands", weak, weak, once=True)) == []
    reason = only(explain(task("tumble_four_hands", weak, weak, weak, once=True)))
    assert "2 tokens must meet this condition, but only hand-4 does" in reason.message


def test_strong_enough_but_too_far() -> None:
    reason = only(explain(task("tumble_two_hands", ("[0, 0, 0.18]", "[2.5, 0, 0.18]"))))
    assert reason.atom == Atom("within_reach", ("hand-2", "box"))
    assert reason.margin == pytest.approx(-0.697)
    assert "(off by 0.697 m; a limit of the available actions, not of physics)" in reason.message
    assert "hand-2 cannot reach its positions beside and above box" in reason.message


def test_both_hands_may_start_on_one_side() -> None:
    assert explain(task("tumble_two_hands", ("[0.5, 0, 0.55]", "[-0.9, 0, 0.55]"))) == []


def test_hands_that_stand_upright() -> None:
    reason = only(explain(task("tumble_two_hands", (ALONG_Y, "rpy: [0, 0, 0]"))))
    assert reason.block == "REACHING:beside"
    assert reason.atom is not None
    assert reason.atom.predicate == "aligned"


def test_a_weak_hand_and_a_far_one_are_each_said() -> None:
    weak, low = (FORCE, "maximal_force: 60"), ("[2.0, 2.0, 1.5]", "[2.0, 2.0, 0.3]")
    start = ("[-0.5, 0, 0.55]", "[-0.5, 0, 0.25]")  # within the low workspace
    atoms = [reason.atom for reason in explain(task("tumble_two_hands", weak, low, start, once=True))]
    assert atoms == [Atom("strong_enough", ("hand-1", "box")), Atom("within_reach", ("hand-1", "box"))]


def test_a_strong_hand_that_is_far_and_a_near_one_that_is_weak() -> None:
    low = ("[2.0, 2.0, 1.5]", "[2.0, 2.0, 0.3]")
    kept = ("[2.0, 2.0, 0.3]", "[2.0, 2.0, 1.5]")
    starts = [("[0.5, 0, 0.55]", "[0.5, 0, 0.25]"), ("[0.6, 0, 0.8]", "[0.6, 0, 0.1]")]  # within the low workspaces
    every = [(FORCE, "maximal_force: 60"), *[low] * 4, kept, *starts]
    atoms = [reason.atom for reason in explain(task("tumble_four_hands", *every, once=True))]
    assert atoms == [Atom("within_reach", ("hand-2", "box"))]


def test_goals_that_exclude_each_other() -> None:
    both = task("tumble_two_boxes_four_hands")
    assert explain(both) == []
    reason = only(explain(both, proven=True))
    assert reason.kind == "together"
    assert "the facts allow each goal atom on its own, but no plan achieves all goal atoms together" in reason.message
    assert reason.goal_text == "posture(box-1, flat right) and posture(box-2, flat right)"


@pytest.mark.parametrize(
    "edit",
    [
        ("mass: 14", "mass: 60"),
        ("[0, 0, 0.18]", "[2.5, 0, 0.18]"),
        (ALONG_Y, "rpy: [0, 0, 0]"),
    ],
)
def test_the_planner_proves_what_the_explanation_says(edit: tuple[str, str]) -> None:
    wrong = task("tumble_two_hands", edit)
    outcome = hybrid_tamp.plan(wrong)
    assert outcome.status == "unsolvable"
    assert outcome.explanation is not None
    # Alternatives to a repair of the fact, such as an additional hand, are also reasons.
    kinds = [reason.kind for reason in outcome.explanation.reasons]
    assert kinds.count("not_feasible") == 1
    assert set(kinds) <= {"not_feasible", "too_few_tokens"}


@pytest.mark.parametrize(("mass", "blocked"), [(14, 0), (32, 0), (34, 2), (40, 2), (52, 2), (53, 0), (60, 0)])
def test_a_box_that_only_the_safety_factor_excludes(mass: float, blocked: int) -> None:
    """Two hands of 300 N bear a box of 32.9 kg with the safety factor 1.6, and a box of 52.7 kg without it."""
    heavy = task("tumble_two_hands", ("mass: 14", f"mass: {mass}"))
    assert len(find_blocked(heavy)) == blocked
    assert (explain(heavy) == []) == (mass < 33)


@settings(max_examples=50, deadline=None)
@given(st.floats(0.1, 0.3), st.floats(0.1, 0.3), st.floats(1.0, 50.0), st.floats(0.0, 2.0))
def test_the_force_needed_is_the_smallest_that_balances_the_moments(
    one: float, other: float, mass: float, friction: float
) -> None:
    start = task("tumble_two_hands")
    box = start.token_by_name["box"]
    properties = {**box.properties, "half_extents": (one, 0.14, other), "mass": mass, "friction": friction}
    made = replace(box, properties=properties)
    height, width = 2.0 * 0.72 * min(one, other), 2.0 * max(one, other)
    lift = np.linspace(0.0, 0.5 * friction, 2001)
    forces = np.hypot(1.0, lift) * mass * 9.81 * width / 2.0 / (height + lift * width)
    assert strength_needed(made, AXIS) == pytest.approx(float(forces.min()), rel=1e-5)
