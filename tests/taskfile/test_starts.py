"""Tests of invalid initial poses: below the floor, inside another token, or forbidden by a class."""

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from texts import load_task_text
from workbench import DOMAIN, ON_ITS_HEAD, block, held

from hybrid_tamp.errors import InputError, Issue
from hybrid_tamp.model.affordance import TOKEN
from hybrid_tamp.model.domain import Domain
from hybrid_tamp.model.grasp import pass_through
from hybrid_tamp.model.predicate import Parameter, Predicate
from hybrid_tamp.taskfile.loader import load_task

TWO_HANDS = (Path(__file__).parents[2] / "problems" / "tumble_two_hands.yaml").read_text(encoding="utf-8")
BOX = "pose: {position: [0, 0, 0.18]}"
HALVES = "[0.15, 0.14, 0.18]"


def refused(text: str, old: str, new: str) -> Issue:
    """Return the only fault of a text after a replacement. ``«`` marks the place of the fault."""
    assert old in text
    marked = text.replace(old, new, 1)
    before, _, _ = marked.partition("«")
    with pytest.raises(InputError) as caught:
        load_task_text(marked.replace("«", ""), "t.yaml")
    (issue,) = caught.value.issues
    if "«" in marked:
        assert issue.where == f"t.yaml:{before.count(chr(10)) + 1}:{len(before) - before.rfind(chr(10))}"
    return issue


def test_bundled_tasks_start_well() -> None:
    for path in (Path(__file__).parents[2] / "problems").glob("*.yaml"):
        load_task(path)


def test_a_box_in_the_floor() -> None:
    said = str(refused(TWO_HANDS, BOX, "pose: {position: «[0, 0, 0.12]}"))
    assert "pose.position of token 'box' must place the token above the floor" in said
    assert "lowest point at z = -0.06 m; raise the token by 0.06 m" in said


def test_less_than_a_millimetre_is_rounding() -> None:
    load_task_text(TWO_HANDS.replace(BOX, "pose: {position: [0, 0, 0.1795]}"), "t")


@pytest.mark.parametrize(
    ("pose", "words"),
    [
        ("{position: [0, 0, 0.30], rpy: [0, 0.35, 0]}", ("13.8 degrees off", "'over right bottom'", "0.0795 m above")),
        ("{position: [0, 0, 0.25]}", ("lowest point is 0.07 m above the floor",)),
        ("{position: [0, 0, 0.2], rpy: [0.15, 0, 0]}", ("8.59 degrees off its nearest posture, 'flat bottom'",)),
    ],
)
def test_a_box_without_a_face_to_stand_on(pose: str, words: tuple[str, ...]) -> None:
    said = str(refused(TWO_HANDS, BOX, f"«pose: {pose}"))
    assert "pose of token 'box' is not valid: the box is in no posture" in said
    assert all(word in said for word in words)


def test_a_box_that_leans_over_an_edge_may_start() -> None:
    # The box is tipped to the right, 6 degrees past the balance point, with its edge on the floor.
    load_task_text(TWO_HANDS.replace(BOX, "pose: {position: [0.0, 0, 0.2331], rpy: [0, 0.7995, 0]}"), "t")


def test_a_box_that_is_too_high_names_the_limit_of_the_method() -> None:
    said = str(refused(TWO_HANDS.replace(BOX, f"«{BOX}"), HALVES, "[0.10, 0.14, 0.18]"))
    assert "must be at most 1.6 times the width of its base, got a height of 0.36 m and a width of 0.2 m" in said


@pytest.mark.parametrize("halves", ["[0.1125, 0.14, 0.18]", "[0.15, 0.05, 0.18]", "[0.18, 0.14, 0.05]"])
def test_what_counts_is_the_base_across_the_hands_and_not_how_flat_it_is(halves: str) -> None:
    pose = f"pose: {{position: [0, 0, {halves[1:-1].split(',')[2]}]}}"
    load_task_text(TWO_HANDS.replace(BOX, pose).replace(HALVES, halves), "t")


def test_a_hand_inside_the_box() -> None:
    said = str(refused(TWO_HANDS, "position: [-0.5, 0, 0.55]", "position: «[-0.1, 0, 0.2]"))
    assert "pose.position of token 'hand-1' must not overlap other tokens" in said
    assert "overlap with token 'box', whose position is on line 22; move token 'hand-1' by [-0.085, 0, 0] m" in said


def test_the_way_out_of_another_token_is_one() -> None:
    said = str(refused(TWO_HANDS, "position: [-0.5, 0, 0.55]", "position: [-0.1, 0, 0.2]"))
    x, y, z = (float(part) for part in said.split("move token 'hand-1' by [")[1].split("]")[0].split(","))
    load_task_text(TWO_HANDS.replace("[-0.5, 0, 0.55]", f"[{x - 0.1}, {y}, {z + 0.2}]"), "t")


def test_two_boxes_in_one_place() -> None:
    other = (
        "  box-2:\n    classes: [TUMBLABLE]\n    properties: {half_extents: [0.15, 0.14, 0.18], mass: 9, friction: 1}"
    )
    said = str(refused(TWO_HANDS, "\ngoal:", f"{other}\n    pose: {{position: «[0.2, 0.2, 0.18]}}\n\ngoal:"))
    assert "token 'box-2'" in said
    assert "overlap with token 'box'" in said


def test_regions_are_places_and_hold_bodies(load: Callable[[str], object], text: str) -> None:
    load(text.replace("[0.8, 0, 0]", "[0, 0, 0]"))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("flat right", "flat sideways", ("must be a posture of a box", "'flat sideways'", "available: flat left")),
        ("flat right", "flat rigth", ("did you mean 'flat right'?",)),
        ("seed: 0", "objective: «fastest", ("objective must be 'length' or 'makespan'", "got 'fastest'")),
        ("seed: 0", "objective: «[makespan]", ("objective must be 'length' or 'makespan'",)),
        ("mass: 14", "mass: «1e300", ("mass of token 'box' must be at most 1e+06 [kg]",)),
        ("maximal_force: 300", "maximal_force: «1e8", ("must be at most 1e+07 [N]",)),
    ],
)
def test_what_tumbling_does_not_know(old: str, new: str, words: tuple[str, ...]) -> None:
    said = str(refused(TWO_HANDS, old, new))
    assert all(word in said for word in words)


@pytest.mark.parametrize("name", [r'"a\e[31m"', r'"a\nb"', r'"a\u200bb"'])
@pytest.mark.parametrize("who", ["hand-1", "robot"])
def test_names_that_would_disturb_a_terminal(name: str, who: str) -> None:
    said = str(refused(TWO_HANDS.replace(who, name), "domain", "domain"))
    assert "must contain only printable characters" in said
    assert said.isprintable()


def test_a_pipe_that_nobody_writes_to_is_an_empty_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="an empty file"):
        load_task(tmp_path / "pipe")


def test_only_hands_that_grip_pass_through_and_only_what_can_be_gripped() -> None:
    hand, hammer, thing = held(0.1, ON_ITS_HEAD, block=block()).tokens
    assert pass_through(hand, hammer)
    assert pass_through(hammer, hand)
    assert not pass_through(hand, thing)
    assert not pass_through(hammer, thing)
    assert not pass_through(hammer, hammer)


ROD = """
domain: bench
tokens:
  hand:
    classes: [HAND]
    properties: {mass: 1}
    shape: {kind: sphere, radius: 0.03}
    pose: {position: [0.3, 0, 0.1]}
  rod:
    classes: [TOOL]
    properties: {mass: 1}
    shape:
      kind: compound
      parts:
        - {kind: box, half_extents: [0.1, 0.01, 0.01], position: [-0.05, 0, 0]}
        - {kind: sphere, radius: 0.05, position: [0.05, 0, 0]}
    pose: {position: [0.55, 0, 0.1], rpy: [0, 0, 3.141592653589793]}
  thing:
    classes: [THING]
    properties: {mass: 1}
    shape: {kind: box, half_extents: [0.02, 0.02, 0.05]}
    pose: {position: [0.3, 0, 0.1]}
goal: [{still: [rod]}]
"""


def bench(name: str) -> Domain:
    return replace(DOMAIN, predicates=(Predicate("still", (Parameter("token", TOKEN),), lambda state, token: 0.0),))


def test_a_hand_may_start_about_what_it_grips_and_nothing_else_in_a_part_of_it() -> None:
    apart = ROD.replace("[0.3, 0, 0.1]}\n  rod", "[0.6, 0, 0.1]}\n  rod")
    load_task_text(apart, "t.yaml", bench)
    load_task_text(apart.replace("[0.02, 0.02, 0.05]", "[0.14, 0.02, 0.05]"), "t.yaml", bench)
    with pytest.raises(InputError, match="overlap with token 'rod'"):
        load_task_text(apart.replace("[0.02, 0.02, 0.05]", "[0.16, 0.02, 0.05]"), "t.yaml", bench)
    with pytest.raises(InputError, match="overlap with token 'thing'"):
        load_task_text(ROD, "t.yaml", bench)
